#include "host_sim/app/fault_walk.hpp"

#include <algorithm>
#include <functional>
#include <span>

#include "host_sim/app/interrupt.hpp"

namespace lf::app {

namespace {

using mission::Step;

constexpr double into_end_s = 0.2;  // of a step that lasts for good: what stopped the arm is done
constexpr double longest_s = 300;   // of a walk
constexpr double after_end_s = 1.0;
// Of the operator. The first tick in `ready` is the homing's last; a stop takes 0.5 s until the power is off.
constexpr double wait_s = 1.0;
constexpr double power_on_s = 0.004;  // the first tick

config::Fault at_step(const char* kind, const char* node, const char* step, double after_s, double duration_s) {
  config::Fault fault;
  fault.kind = kind;
  fault.node = node;
  fault.at_step = step;
  fault.after_s = after_s;
  fault.duration_s = duration_s;
  return fault;
}

struct Stay {
  Step step;
  double begin_s, end_s;
};

// Until `enough` of the stays that are over, or to the walk's end.
std::vector<Stay> stays_of(FaultWalk walk, const scenario::Scenario& base, const std::function<bool(std::span<const Stay>)>& enough) {
  hal::SimObserver nobody;
  Flight flight(walk.with_its_faults(base), 1, nobody);
  std::vector<Stay> stays;
  double ended_s = -1;
  while (!interrupted() && flight.now().s() < longest_s && (ended_s < 0 || flight.now().s() < ended_s + after_end_s)) {
    walk.give_orders(flight);
    flight.step();
    const double now_s = flight.now().s();
    if (stays.empty() || stays.back().step != flight.mission_step()) {
      if (enough(stays)) return stays;
      stays.push_back({flight.mission_step(), now_s, now_s});
    }
    stays.back().end_s = now_s;
    const bool back_from_jog = walk.by_hand() && stays.size() > 2 && stays[stays.size() - 2].step == Step::jog;
    const bool ended = flight.mission().outcome().ended && !walk.goes_on_after(flight);
    if (ended_s < 0 && (ended || back_from_jog)) ended_s = now_s;
  }
  return stays;
}

}  // namespace

FaultWalk::FaultWalk(std::string name) : name_(std::move(name)) {}

const std::vector<std::string>& FaultWalk::names() {
  static const std::vector<std::string> all{"mission", "by hand", "aborted", "stopped", "held", "shut down", "started anew"};
  return all;
}

scenario::Scenario FaultWalk::with_its_faults(const scenario::Scenario& base) const {
  scenario::Scenario walked = base;
  if (name_ == "aborted") walked.faults.push_back(at_step("abort_ordered", "", "turn", 1, 0));
  if (name_ == "stopped") walked.faults.push_back(at_step("estop_ordered", "", "deploy", 1, 0));
  if (stops_and_starts_anew()) walked.faults.push_back(at_step("estop_ordered", "", "turn", 1, 0));
  if (name_ == "held") walked.faults.push_back(at_step("torque_high", base.joints[1].c_str(), "deploy", 1, 0.1));
  if (name_ == "shut down") walked.faults.push_back(at_step("shut_down_ordered", "", "deploy", 1, 0));
  return walked;
}

void FaultWalk::give_orders(Flight& flight) {
  if (!begun_) flight.order(by_hand() ? Command::home : Command::start);
  begun_ = true;
  if (stops_and_starts_anew() && !started_anew_) start_anew(flight);
  if (by_hand() && !jogged_ && flight.mission_step() == Step::ready) jog(flight);
}

void FaultWalk::start_anew(Flight& flight) {
  if (goes_on_after(flight) && waiting_s_ < 0) waiting_s_ = flight.now().s();
  if (waiting_s_ < 0) return;
  const double waited_s = flight.now().s() - waiting_s_;
  if (!reset_ && waited_s > wait_s) reset_ = flight.order(Command::reset);
  if (reset_ && waited_s > 2 * wait_s) started_anew_ = flight.order(Command::start);
}

void FaultWalk::jog(Flight& flight) {
  mission::Order jog;
  jog.command = Command::jog;
  jog.joint = 0;
  jog.by_rad = -0.2;
  if (waiting_s_ < 0) waiting_s_ = flight.now().s();
  if (flight.now().s() > waiting_s_ + wait_s) jogged_ = flight.order(jog);
}

std::vector<FaultMoment> survey_moments(const scenario::Scenario& base, double share_of_step, const std::set<std::string>& wanted) {
  std::vector<FaultMoment> moments{{"mission", Step::idle, "power-on", power_on_s, power_on_s}};
  std::set<Step> known{Step::idle};
  const auto enough = [&](std::span<const Stay> stays) {
    const auto is_known = [&](const std::string& name) {
      const auto is_it = [&](Step step) { return step != Step::idle && mission::row(step).name == name; };
      return name == moments.front().name || std::any_of(known.begin(), known.end(), is_it) ||
             std::any_of(stays.begin(), stays.end(), [&](const Stay& stay) { return is_it(stay.step); });
    };
    return !wanted.empty() && std::all_of(wanted.begin(), wanted.end(), is_known);
  };
  for (const std::string& name : FaultWalk::names()) {
    if (interrupted() || enough({})) break;
    for (const Stay& stay : stays_of(FaultWalk(name), base, enough)) {
      if (!known.insert(stay.step).second) continue;
      const double in_s = mission::is_end(stay.step) ? into_end_s : share_of_step * (stay.end_s - stay.begin_s);
      moments.push_back({name, stay.step, mission::row(stay.step).name, stay.begin_s + in_s, in_s});
    }
  }
  return moments;
}

}  // namespace lf::app
