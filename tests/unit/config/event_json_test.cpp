#include "hal/config/event_json.hpp"

#include <gtest/gtest.h>

namespace lf::config {
namespace {

Event fault_event(safety::Fault fault, std::int32_t code) {
  Event event;
  event.kind = Event::Kind::fault;
  event.t = Time::from_ns(15'000'172'000);
  event.step = mission::Step::perceive;
  event.fault = fault;
  event.reaction = safety::Reaction::retry;
  event.code = code;
  return event;
}

TEST(EventJson, AFailedLookHasItsCauseItsRemedyAndWhatItSaw) {
  mission::Sight white;
  white.look = 1;
  white.stripes = 10;
  white.still_taken = true;
  white.still = {255, 0, 1};
  const auto json = event_json(fault_event(safety::Fault::vision_poor, static_cast<std::int32_t>(StepFailure::no_panel)), {}, white);
  EXPECT_EQ(json["t_s"].dump(), "15.000172");
  EXPECT_EQ(json["kind"], "fault");
  EXPECT_EQ(json["step"], "perceive");
  EXPECT_EQ(json["reaction"], "retry");
  EXPECT_EQ(json["because"], "no panel seen");
  EXPECT_EQ(json["cause"], "no panel seen: the pictures are white");
  EXPECT_NE(json["remedy"].get<std::string>().find("camera.exposure_us"), std::string::npos);
  EXPECT_NE(json["seen"].get<std::string>().find("100 % white"), std::string::npos);
}

TEST(EventJson, ADrivesFaultNamesItsJoint) {
  const auto json = event_json(fault_event(safety::Fault::drive_fault, 2), {}, {});
  EXPECT_EQ(json["text"], "drive fault: elbow");
  EXPECT_FALSE(json.contains("cause"));
  EXPECT_FALSE(json["remedy"].get<std::string>().empty());
  EXPECT_FALSE(json.contains("seen"));
}

TEST(EventJson, OnlyFaultsThatHappenedAreCounted) {
  std::array<std::uint32_t, safety::fault_count> counts{};
  counts[static_cast<std::size_t>(safety::Fault::estop)] = 3;
  EXPECT_EQ(fault_counts_json(counts).dump(), R"({"emergency stop":3})");
}

}  // namespace
}  // namespace lf::config
