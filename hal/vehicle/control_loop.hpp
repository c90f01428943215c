// The control thread and the vision thread of the vehicle: the core's turns (hal/core_loop.hpp) with everything around them that takes no heap and no time.
//
// Orders come in and answers, reports and port faults go out through single-producer single-consumer rings; nothing else is shared. The same loops run on
// any platform that the concept describes and that can wait for an image: tests drive them with a scripted one.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include "firmware/controller.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/core_loop.hpp"
#include "hal/heap_guard/heap_guard.hpp"
#include "hal/vehicle/control_report.hpp"
#include "hal/vehicle/latency_histogram.hpp"
#include "hal/vehicle/realtime.hpp"
#include "hal/vehicle/tick_clock.hpp"
#include "shared/messages/spsc_ring.hpp"

namespace lf::hal {

struct NumberedOrder {
  std::uint64_t number = 0;
  mission::Order order;
};

struct OrderAnswer {
  std::uint64_t number = 0;
  bool taken = false;
  mission::Standing standing = mission::Standing::idle;  // when it was judged
};

struct PortFault {
  Port port = Port::camera;
  PortStatus code = port_ok;
};

struct LoopRings {
  CoreRings core;
  SpscRing<NumberedOrder, 16> orders;     // operator -> control
  SpscRing<OrderAnswer, 16> answers;      // control -> operator
  SpscRing<ControlReport, 8> reports;     // control -> writer
  SpscRing<CameraReport, 8> cameras;      // vision -> writer
  SpscRing<PortFault, 64> vision_faults;  // vision -> control
};

// Times the core's work: by the clock, and in processor time.
class TimingProbe {
 public:
  void begin() {
    began_ = monotonic_now();
    thread_began_ = thread_time_now();
  }
  void end() {
    worked_.add(thread_time_now() - thread_began_);
    took_.add(monotonic_now() - began_);
  }
  const LatencyHistogram& took() const { return took_; }
  const LatencyHistogram& worked() const { return worked_; }

 private:
  Time began_, thread_began_;
  LatencyHistogram took_, worked_;
};

// Reports leave every so many ticks.
inline constexpr std::uint64_t ticks_a_report = 25;
// After the nodes were told to stop the loop goes on for as long as Network::shut_down needs, and a little.
inline constexpr int ticks_to_stop = 10;

template <class P>
class ControlLoop {
 public:
  ControlLoop(P& platform, const ControllerConfig& config, LoopRings& rings)
      : platform_(platform), rings_(rings), controller_(std::make_unique<Controller>(config)) {}

  // One control period. `fill` completes a report with what only the platform knows.
  template <class Fill>
  void turn(Fill fill) {
    {
      const CoreSection guarded;  // the whole of the turn, not only the core in it
      take_orders();
      for (PortFault fault; rings_.vision_faults.pop(fault);) controller_->on_port_error(fault.port, fault.code, now_);
      control_turn(platform_, *controller_, rings_.core, out_, now_, probe_);
      if (ticks_++ % ticks_a_report == 0 || ended_now()) report(fill);
    }
    if (stopping_ && controller_->mission().over() && ticks_left_ > 0) --ticks_left_;
  }

  // Everything is stopped and the nodes know it.
  bool stopped() const { return stopping_ && ticks_left_ == 0; }
  const Controller& controller() const { return *controller_; }
  const LatencyHistogram& tick_latency() const { return probe_.took(); }
  const LatencyHistogram& tick_work() const { return probe_.worked(); }
  std::uint64_t ticks() const { return ticks_; }

  template <class Fill>
  void report(Fill fill) {
    fill_report();
    fill(report_);
    (void)rings_.reports.push(report_);  // a full ring: the next one says more
  }

 private:
  void take_orders() {
    for (NumberedOrder order; rings_.orders.pop(order);) {
      OrderAnswer answer;
      answer.number = order.number;
      answer.standing = controller_->mission().standing();
      answer.taken = controller_->on_order(order.order, now_);
      stopping_ = stopping_ || order.order.command == Command::shut_down;
      (void)rings_.answers.push(answer);
    }
  }

  bool ended_now() {
    const bool ended = controller_->mission().outcome().ended;
    return std::exchange(had_ended_, ended) != ended;
  }

  void fill_report() {
    const mission::Mission& mission = controller_->mission();
    report_.t = now_;
    report_.standing = mission.standing();
    report_.step = mission.step();
    report_.outcome = mission.outcome();
    report_.faults_after_end = mission.faults_after_end();
    report_.tasks = mission.tasks();
    const canopen::Network& network = controller_->network();
    for (std::size_t i = 0; i < joint_count; ++i) {
      report_.axes[i] = network.axis(static_cast<Joint>(i)).state();
      report_.axis_faults[i] = network.axis(static_cast<Joint>(i)).fault();
    }
    report_.inputs = network.io().inputs();
    report_.outputs = network.io().outputs();
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
  TickOutput out_;
  ControlReport report_;
  TimingProbe probe_;
  Time now_;
  std::uint64_t ticks_ = 0;
  bool stopping_ = false;
  bool had_ended_ = false;
  int ticks_left_ = ticks_to_stop;
};

template <class P>
class VisionLoop {
 public:
  VisionLoop(P& platform, const ScanConfig& config, LoopRings& rings)
      : platform_(platform), rings_(rings), pipeline_(std::make_unique<ScanPipeline>(config)) {}

  void turn() {
    vision_turn(platform_, *pipeline_, rings_.core, probe_, [this](Port port, PortStatus code) {
      (void)rings_.vision_faults.push({port, code});
    });
  }
  const LatencyHistogram& image_latency() const { return probe_.took(); }

 private:
  P& platform_;
  LoopRings& rings_;
  std::unique_ptr<ScanPipeline> pipeline_;
  TimingProbe probe_;
};

}  // namespace lf::hal
