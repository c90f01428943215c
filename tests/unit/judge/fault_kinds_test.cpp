// The tables of faults against each other: whatever a scenario may name is made somewhere, and has a rule by which it is judged.
#include "hal/config/fault_kinds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "hal/sim/sim_faults.hpp"
#include "host_sim/judge/fault_rules.hpp"
#include "host_sim/scenario/instance.hpp"

namespace lf::judge {
namespace {

TEST(FaultKinds, EachIsMadeByTheSimulatorAndHasARule) {
  for (const config::FaultKind& kind : config::fault_kinds()) {
    SCOPED_TRACE(kind.name);
    const auto rules = fault_rules();
    EXPECT_TRUE(std::any_of(rules.begin(), rules.end(), [&](const FaultRule& rule) { return rule.kind == kind.name; }));
    if (kind.place == config::FaultPlace::told) continue;
    config::Fault fault;
    fault.kind = kind.name;
    EXPECT_NO_THROW(scenario::sim_fault(fault, config::Drives{}, {}));
  }
}

TEST(FaultKinds, EachRuleIsOfAKindAndAsksForWhatItSays) {
  for (const FaultRule& rule : fault_rules()) {
    SCOPED_TRACE(rule.kind);
    EXPECT_NE(config::find_fault_kind(rule.kind), nullptr);
    EXPECT_EQ(rule.named_by.empty(), rule.demand == Demand::go_on) << "what ends a mission has a name";
    EXPECT_EQ(rule.report == Report::none, rule.demand != Demand::stop) << "a stop counts from a report";
  }
}

TEST(FaultKinds, CausesAreAllDifferentAndLostFramesHaveAnIdentifier) {
  std::set<std::string> names;
  for (const Cause& cause : all_causes()) {
    EXPECT_TRUE(names.insert(cause.name()).second) << cause.name();
    const config::Fault fault = cause.fault();
    EXPECT_EQ(fault.can_id != 0, fault.kind == "drop_frames") << cause.name();
  }
  EXPECT_GT(names.size(), 100u);
  EXPECT_TRUE(names.contains("drop_frames tpdo io"));
  EXPECT_TRUE(names.contains("drop_frames heartbeat slew"));
  EXPECT_TRUE(names.contains("drop_frames emcy jaw"));
  EXPECT_TRUE(names.contains("bus_off master"));
}

// CiA 301's pre-defined connection set; slew is node 1, the output node 6.
TEST(FaultKinds, LostFramesHaveTheIdentifiersOfTheirNodes) {
  const std::map<std::string, std::int64_t> ids{{"tpdo slew", 0x181},    {"rpdo io", 0x206},   {"heartbeat slew", 0x701},
                                                {"heartbeat io", 0x706}, {"emcy slew", 0x081}, {"emcy io", 0x086}};
  std::set<std::string> found;
  for (const Cause& cause : all_causes()) {
    const auto id = ids.find(cause.node);
    if (id == ids.end()) continue;
    EXPECT_EQ(cause.fault().can_id, id->second) << cause.name();
    found.insert(cause.node);
  }
  EXPECT_EQ(found.size(), ids.size());
}

hal::SimFault at(double s) {
  hal::SimFault fault;
  fault.kind = hal::SimFaultKind::camera_silent;
  fault.at_s = s;
  return fault;
}

TEST(FaultSchedule, BeginsAtItsTimeAndEndsAfterItsDuration) {
  hal::SimFault fault = at(2);
  fault.duration_s = 0.5;
  hal::FaultSchedule schedule({fault});
  EXPECT_EQ(schedule.next(Time::from_s(1.999)), nullptr);
  ASSERT_NE(schedule.next(Time::from_s(2)), nullptr);
  EXPECT_EQ(schedule.next(Time::from_s(2)), nullptr) << "once";
  EXPECT_TRUE(schedule.on(hal::SimFaultKind::camera_silent));
  schedule.next(Time::from_s(2.499));
  EXPECT_TRUE(schedule.on(hal::SimFaultKind::camera_silent));
  schedule.next(Time::from_s(2.5));
  EXPECT_FALSE(schedule.on(hal::SimFaultKind::camera_silent));
}

TEST(FaultSchedule, AtAStepItCountsFromWhenTheMissionFirstEntersIt) {
  hal::SimFault fault = at(0);
  fault.at_step = mission::Step::turn;
  fault.after_s = 1;
  hal::FaultSchedule schedule({fault});
  schedule.in_step(mission::Step::scan, Time::from_s(3));
  EXPECT_EQ(schedule.next(Time::from_s(9)), nullptr);
  schedule.in_step(mission::Step::turn, Time::from_s(10));
  schedule.in_step(mission::Step::let_go, Time::from_s(10.5));
  schedule.in_step(mission::Step::turn, Time::from_s(10.9));
  EXPECT_EQ(schedule.next(Time::from_s(10.99)), nullptr);
  EXPECT_NE(schedule.next(Time::from_s(11)), nullptr);
}

TEST(FaultSchedule, AFaultAddedInItsStepCountsFromTheStepsBeginning) {
  hal::FaultSchedule schedule({});
  schedule.in_step(mission::Step::turn, Time::from_s(10));
  hal::SimFault fault = at(0);
  fault.at_step = mission::Step::turn;
  fault.after_s = 1;
  schedule.add(fault);
  EXPECT_EQ(schedule.next(Time::from_s(10.5)), nullptr);
  EXPECT_NE(schedule.next(Time::from_s(11)), nullptr);
}

}  // namespace
}  // namespace lf::judge
