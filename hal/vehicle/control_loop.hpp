// The control thread and the vision thread of the vehicle: the core's turns (hal/core_loop.hpp) with everything around them that takes no heap and no time.
//
// Reports and port faults go out through single-producer single-consumer rings; everything else goes through the platform's ports. The same loops run on
// any platform that the concept describes: tests drive them with a scripted one. `Probe` has begin() and end(), called around the core's work.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "firmware/controller.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/core_loop.hpp"
#include "hal/heap_guard/heap_guard.hpp"
#include "hal/vehicle/commissioning.hpp"
#include "hal/vehicle/control_report.hpp"
#include "hal/vehicle/order_gate.hpp"
#include "shared/messages/spsc_ring.hpp"

namespace lf::hal {

struct PortFault {
  Port port = Port::camera;
  PortStatus code = port_ok;
};

struct CommissioningLoan {
  Commissioning* commissioning = nullptr;
  Time expires = Time::from_ns(std::numeric_limits<std::int64_t>::max());  // not begun later: nobody expects it any more
};

struct CommissioningResult {
  Commissioning* commissioning = nullptr;
  bool begun = false;  // false: the arm had power, another one is under way, or it was called off or late
};

struct LoopRings {
  CoreRings core;
  SpscRing<NumberedOrder, 16> orders;    // operator -> control
  SpscRing<NumberedOrder, 16> stops;     // operator -> control: emergency stops, which no other order keeps out
  SpscRing<NumberedOrder, 8> own;        // the daemon's own orders -> control; their number is 0
  SpscRing<OrderAnswer, 8> own_answers;  // control -> the daemon
  SpscRing<OrderAnswer, 64> answers;     // control -> operator
  OrderGate gate;                        // over `orders` and `stops`
  SpscRing<ControlReport, 8> reports;    // control -> status
  // A commissioning is lent to the control thread and comes back when it has ended, or at once when it cannot begin. A core with other zeros is exchanged
  // for the one before while nothing has power. Whoever lends owns: the control thread neither makes nor deletes.
  SpscRing<CommissioningLoan, 2> commissionings;  // operator -> control
  std::atomic<bool> loan_is_void{false};          // operator -> control: the one that is lent shall not begin any more
  SpscRing<CommissioningResult, 4> commissioned;  // control -> operator
  SpscRing<Controller*, 2> cores;                 // operator -> control
  SpscRing<Controller*, 2> old_cores;             // control -> operator
  SpscRing<CameraReport, 8> cameras;              // vision -> status
  SpscRing<PortFault, 64> vision_faults;          // vision -> control
};

// Reports leave every so many ticks.
inline constexpr std::uint64_t ticks_a_report = 25;
// After the nodes were told to stop the loop goes on for as long as Network::shut_down needs, and a little.
inline constexpr int ticks_to_stop = 10;

template <Platform P, class Probe = NoProbe>
class ControlLoop {
 public:
  ControlLoop(P& platform, const ControllerConfig& config, LoopRings& rings)
      : platform_(platform), rings_(rings), controller_(std::make_unique<Controller>(config)) {}

  // One control period. `fill` completes a report with what only the platform knows.
  template <class Fill>
  void turn(Fill fill) {
    {
      const CoreSection guarded;  // the whole of the turn, not only the core in it
      for (PortFault fault; rings_.vision_faults.pop(fault);) controller_->on_port_error(fault.port, fault.code, now_);
      take_loans();
      const bool shut_down = commissioning_ != nullptr ? commissioning_turn() : core_turn();
      stopping_ = stopping_ || shut_down;
      if (ticks_++ % ticks_a_report == 0 || ended_now()) report(fill);
    }
    if (stopping_ && commissioning_ == nullptr && controller_->mission().over() && ticks_left_ > 0) --ticks_left_;
  }

  // Everything is stopped and the nodes know it.
  bool stopped() const { return stopping_ && ticks_left_ == 0; }
  const Controller& controller() const { return *controller_; }
  const Probe& probe() const { return probe_; }
  std::uint64_t ticks() const { return ticks_; }

  template <class Fill>
  void report(Fill fill) {
    fill_report();
    fill(report_);
    (void)rings_.reports.push(report_);  // a full ring: the next one says more
  }

 private:
  bool core_turn() {
    core_has_turned_ = true;
    return control_turn(platform_, *controller_, rings_.core, out_, now_, probe_);
  }

  // Nothing has power: the bus may be handed over, and the core exchanged.
  bool at_rest() const {
    const mission::Standing standing = controller_->mission().standing();
    if (stopping_ || (standing != mission::Standing::idle && standing != mission::Standing::ended)) return false;
    if (!controller_->mission().power().off()) return false;
    for (std::size_t i = 0; i < controller_->network().drive_count(); ++i) {
      // What its drive said last: after a mission the nodes are stopped, and say no more.
      if (controller_->network().axis(i).powered()) return false;
    }
    return true;
  }

  // After a stop or a fault the operator resets first.
  bool has_to_be_reset() const {
    const mission::Mission& mission = controller_->mission();
    const bool stopped_since = mission.faults_after_end()[static_cast<std::size_t>(safety::Fault::estop)] > 0;
    return mission.outcome().ended && (!mission.outcome().success || stopped_since);
  }

  // The core first: a commissioning that is lent while another one's zeros wait would find the old ones.
  void take_loans() {
    // Not in the turn after a commissioning: a stop that came at its end is in the core's mailbox, and still has to end the mission.
    if (commissioning_ == nullptr && core_has_turned_ && at_rest() && !has_to_be_reset()) {
      if (Controller* next = nullptr; rings_.cores.pop(next)) {
        hand_over(*controller_, *next);
        (void)rings_.old_cores.push(controller_.release());
        controller_.reset(next);
        ++report_.cores_taken;
      }
    }
    for (CommissioningLoan next; rings_.commissionings.pop(next);) {
      const bool wanted = !rings_.loan_is_void.load(std::memory_order_acquire) && now_ <= next.expires;
      if (commissioning_ == nullptr && wanted && at_rest() && !has_to_be_reset()) {
        commissioning_ = next.commissioning;
        tell_lost_zeros(*commissioning_);
      } else {
        (void)rings_.commissioned.push({next.commissioning, false});
      }
    }
  }

  // It hears the drives from now on, and may have been made before they said so.
  void tell_lost_zeros(Commissioning& begun) const {
    for (std::size_t i = 0; i < controller_->network().drive_count(); ++i) {
      if (controller_->network().axis(i).zero_lost()) begun.lose_zero(i);
    }
  }

  // Its drive has lost it, and it was not found since.
  bool zero_lost(const Controller& core, std::size_t joint) const {
    const canopen::Axis& axis = core.network().axis(joint);
    return axis.zero_lost() && !(found_[joint] && axis.stats().zeros_lost == losses_when_found_[joint]);
  }

  // What the core before was told since it began, and what it has heard of its drives: a zero that was lost after it was found is lost.
  void hand_over(const Controller& before, Controller& next) {
    mission::Order order;
    order.command = Command::set_tasks;
    for (const mission::TaskResult& result : before.mission().tasks()) (void)order.tasks.push_back(result.task);
    (void)next.on_order(order, now_);
    const std::size_t joints = before.network().drive_count();
    for (std::size_t i = 0; i < joints; ++i) {
      if (zero_lost(before, i)) next.lose_zero(i);
    }
    if (before.mission().jaw_doubted() && !found_[joints - 1]) next.doubt_jaw();  // the jaw is the last
    found_.fill(false);
  }

  // The core was not told what its drives said meanwhile.
  void note_zeros(const Commissioning& ended) {
    const PerJoint<bool> lost = ended.zeros_lost();
    for (std::size_t i = 0; i < controller_->network().drive_count(); ++i) {
      if (lost[i]) controller_->lose_zero(i);
      found_[i] = ended.state() == Commissioning::State::done && ended.found()[i] && !lost[i];
      losses_when_found_[i] = controller_->network().axis(i).stats().zeros_lost;
    }
  }

  // One period of commissioning, under the same clock, bus, emergency stops and orders as the core's. True when the end of the program was ordered in it.
  bool commissioning_turn() {
    Time tick = now_;
    const bool clock = platform_.wait_for_tick(tick) == port_ok;
    now_ = clock ? tick : now_ + can_map::sync_period;
    if (!clock) commissioning_->stop("the clock failed");
    probe_.begin();
    bool closed = false;
    if (platform_.read_estop(closed) != port_ok || !closed) commissioning_->emergency_stop("the emergency-stop input is open");
    const bool shut_down = take_orders_meanwhile();
    stopping_ = stopping_ || shut_down;
    hear_bus();
    canopen::Outbox outbox;
    commissioning_->tick(now_, outbox);
    probe_.end();
    if (platform_.send_can(0, {outbox.data(), outbox.size()}) != port_ok) commissioning_->stop("the bus does not take frames");
    if (commissioning_->ended()) {
      // The core latches it, and wants its reset.
      if (commissioning_->emergency_stopped()) (void)controller_->on_command(Command::emergency_stop, now_);
      note_zeros(*commissioning_);
      ++report_.commissionings_ended;
      core_has_turned_ = false;
      (void)rings_.commissioned.push({std::exchange(commissioning_, nullptr), true});
      if (stopping_) (void)controller_->on_command(Command::shut_down, now_);
    }
    return shut_down;
  }

  // Whatever stops is taken, everything else is refused.
  bool take_orders_meanwhile() {
    bool shut_down = false;
    for (NumberedOrder order; platform_.receive_order(order) == port_ok;) {
      const Command command = order.order.command;
      if (command == Command::emergency_stop) commissioning_->emergency_stop("an emergency stop was ordered");
      if (command == Command::abort) commissioning_->stop("it was called off");
      if (command == Command::shut_down) commissioning_->stop("the program ends");
      shut_down = shut_down || command == Command::shut_down;
      OrderAnswer answer;
      answer.number = order.number;
      answer.commissioning = true;
      answer.taken = command == Command::emergency_stop || command == Command::abort || command == Command::shut_down;
      (void)platform_.answer_order(answer);
    }
    return shut_down;
  }

  void hear_bus() {
    for (int i = 0; i < max_frames_a_tick; ++i) {
      ReceivedFrame received;
      const PortStatus status = platform_.receive_can(0, received);
      if (status == port_empty) return;
      if (status != port_ok) return commissioning_->stop("the bus cannot be read");
      commissioning_->on_frame(received.frame, received.t);
    }
  }

  bool ended_now() {
    const bool ended = controller_->mission().outcome().ended;
    return std::exchange(had_ended_, ended) != ended;
  }

  void fill_report() {
    const mission::Mission& mission = controller_->mission();
    report_.t = now_;
    report_.commissioning = commissioning_ != nullptr;
    if (commissioning_ != nullptr) {
      report_.commissioning_state = commissioning_->state();
      report_.commissioning_joint = commissioning_->joint();
    }
    report_.standing = mission.standing();
    report_.step = mission.step();
    report_.outcome = mission.outcome();
    report_.faults_after_end = mission.faults_after_end();
    report_.tasks = mission.tasks();
    const canopen::Network& network = controller_->network();
    for (std::size_t i = 0; i < network.drive_count(); ++i) {
      report_.axes[i] = network.axis(i).state();
      report_.zeros_lost[i] = zero_lost(*controller_, i) && !network.axis(i).may_have_power();
      report_.axis_faults[i] = network.axis(i).fault();
    }
    report_.jaw_doubted = mission.jaw_doubted();
    const canopen::IoModule& io = commissioning_ != nullptr ? commissioning_->io() : network.io();
    report_.inputs = io.inputs();
    report_.inputs_fresh = io.seen() && io.fresh(report_.t);
    report_.outputs = io.outputs();
    report_.boot = network.boot();
    report_.network = network.stats();
    report_.port_errors = controller_->port_errors();
    report_.orders_refused = controller_->orders_refused();
    report_.rejected_inputs = controller_->rejected_inputs();
    report_.scan = controller_->scan_stats();
    report_.ticks = ticks_;
    report_.heap_calls = HeapGuard::calls();
  }

  P& platform_;
  LoopRings& rings_;
  std::unique_ptr<Controller> controller_;
  Commissioning* commissioning_ = nullptr;  // lent
  bool core_has_turned_ = true;             // since the last one
  // Of the last one, for the core that brings its zeros; and how often each had been lost by then.
  PerJoint<bool> found_{};
  PerJoint<std::uint32_t> losses_when_found_{};
  TickOutput out_;
  ControlReport report_;
  Probe probe_;
  Time now_;
  std::uint64_t ticks_ = 0;
  bool stopping_ = false;
  bool had_ended_ = false;
  int ticks_left_ = ticks_to_stop;
};

template <Platform P, class Probe = NoProbe>
class VisionLoop {
 public:
  VisionLoop(P& platform, const ScanConfig& config, LoopRings& rings)
      : platform_(platform), rings_(rings), pipeline_(std::make_unique<ScanPipeline>(config)) {}

  // Waits for an image and works on it.
  void turn() {
    (void)platform_.wait_for_image();
    vision_turn(platform_, *pipeline_, rings_.core, probe_, [this](Port port, PortStatus code) {
      (void)rings_.vision_faults.push({port, code});
    });
  }
  const Probe& probe() const { return probe_; }

 private:
  P& platform_;
  LoopRings& rings_;
  std::unique_ptr<ScanPipeline> pipeline_;
  Probe probe_;
};

}  // namespace lf::hal
