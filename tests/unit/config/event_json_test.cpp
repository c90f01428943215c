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

TEST(EventJson, APanelThatWasFoundTellsWhatItsLookLeftOver) {
  Event event;
  event.kind = Event::Kind::located;
  mission::Sight sight;
  EXPECT_FALSE(event_json(event, {}, sight).contains("fit"));
  sight.fit = {true, 0.08f, 32, 0.0009765625f, 0.00025f, 0.0005f, 0.001f};
  const auto good = event_json(event, {}, sight)["fit"];
  EXPECT_NEAR(good["marker_side_percent"], 0.09765625, 1e-9);
  EXPECT_NEAR(good["marker_corners_mm"], 0.25, 1e-6);
  EXPECT_NEAR(good["plane_bend_mm"], 0.5, 1e-6);
  EXPECT_NEAR(good["panel_shift_mm"], 1, 1e-6);
  EXPECT_FALSE(good.contains("doubt"));
  sight.fit.marker_side_error = -0.03f;
  const auto doubted = event_json(event, {}, sight)["fit"];
  EXPECT_TRUE(doubted.contains("doubt"));
  EXPECT_TRUE(doubted.contains("remedy"));
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
