#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/config/limits_file.hpp"
#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

namespace lf::config {

namespace {

std::string shipped_text() { return read_text_file(share_folder() / "safety" / "limits.yaml"); }

std::string changed(const std::string& from, const std::string& to) {
  std::string text = shipped_text();
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string said_of(const std::string& text) {
  const scenario::ScenarioFile file(text);
  try {
    (void)read_limits(file.path(), {});
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

// The shipped limits with one change and the checksum that goes with it.
std::string whole(const std::string& from, const std::string& to) {
  std::string text = changed(from, to);
  const std::string told = said_of(text);
  const std::size_t at = told.rfind("0x");
  if (at == std::string::npos) return text;
  const std::size_t stated = text.find("checksum: 0x") + 10;
  return text.replace(stated, 10, told.substr(at, 10));
}

// What `default` says of the changed limits, once as the machine's and once as the mission's own.
void expect_refused(const std::string& from, const std::string& to, const std::vector<std::string>& parts) {
  const scenario::ScenarioFile file(whole(from, to));
  for (const char* key : {"safety.limits", "safety.mission_limits"}) {
    try {
      scenario::check_runnable(scenario::load_scenario("default", {std::string(key) + "=" + file.path()}));
      ADD_FAILURE() << key << ": " << to << " is accepted";
    } catch (const InputError& error) {
      for (const std::string& part : parts) EXPECT_THAT(error.what(), ::testing::HasSubstr(part)) << key;
    }
  }
}

}  // namespace

TEST(Limits, WhatKeepsTheArmFromItsWorkIsRefusedBeforeItMoves) {
  expect_refused("max_rad: 2.13294", "max_rad: 2.0", {"'joints.elbow.max_rad' is 2: the sweep's start takes the elbow to 2.0"});
  expect_refused("max_rad: 2.13294", "max_rad: 1.8", {"'joints.elbow.max_rad' is 1.8: the arm's folded pose takes the elbow to 1.9"});
  expect_refused("min_m: [-0.35,", "min_m: [0.3,", {"'workspace.min_m' has 0.3 for x: the arm's folded pose takes the tool to"});
  expect_refused("max_m: [0.472, 0.6, 0.93]", "max_m: [0.472, 0.6, 0.5]", {"'workspace.max_m' has 0.5 for z: the valve takes the tool to"});
}

TEST(Limits, ATorqueThatFreeMotionTakesIsNoLimit) {
  expect_refused("max_rad: 2.13294, max_speed_rad_s: 0.36, max_torque_nm: 26", "max_rad: 2.13294, max_speed_rad_s: 0.36, max_torque_nm: 1",
                 {"'joints.elbow.max_torque_nm' is 1", "its free motion takes up to 9 N m", "more than 18 N m"});
  expect_refused("max_contact_torque_nm: 13", "max_contact_torque_nm: 8", {"'max_contact_torque_nm' is 8"});
}

TEST(Limits, ATimeThatIsOverBeforeAnImageOrAnAnswerCanBeThereIsRefused) {
  expect_refused("stale_image_s: 0.2", "stale_image_s: 0.001", {"'stale_image_s' is 0.001", "its exposure has ended, after 0.002 s"});
  expect_refused("stale_image_s: 0.2", "stale_image_s: 0.01", {"'latency.image_ms' is 30: by 'stale_image_s'", "later than 6 ms"});
  expect_refused("vision_timeout_s: 2.0", "vision_timeout_s: 0.001", {"'latency.panel_vision_ms' is 300: by 'vision_timeout_s'"});
}

TEST(Limits, TheShippedFileIsGoodAndTheCoreAgrees) {
  const safety::Limits limits = read_limits(share_folder() / "safety" / "limits.yaml", {});
  EXPECT_EQ(safety::check(limits), safety::LimitsVerdict::good);
  EXPECT_EQ(limits.stale_position_s, 0.012) << "three SYNC cycles";
}

TEST(Limits, AChangedValueWithoutItsChecksumIsRefusedAndTheRightOneNamed) {
  EXPECT_THAT(said_of(changed("max_contact_torque_nm: 13", "max_contact_torque_nm: 14")), ::testing::HasSubstr("these limits give 0x"));
}

TEST(Limits, EveryLimitHasToBeStated) {
  EXPECT_THAT(said_of(changed("vision_timeout_s: 2.0", "")), ::testing::HasSubstr("'vision_timeout_s' is missing"));
  EXPECT_THAT(said_of(changed("max_torque_nm: 26}", "}")), ::testing::HasSubstr("'joints.slew.max_torque_nm' is missing"));
}

TEST(Limits, MisspeltAndSenselessOnesAreRefusedWithTheirLine) {
  EXPECT_THAT(said_of(changed("stale_image_s", "stale_imag_s")), ::testing::HasSubstr("did you mean 'stale_image_s'?"));
  EXPECT_THAT(said_of(changed("vision_timeout_s: 2.0", "vision_timeout_s: .nan")), ::testing::HasSubstr("must be a finite number"));
  EXPECT_THAT(said_of(changed("checksum: 0x", "checksum: 1x")), ::testing::HasSubstr("'checksum' takes 0x and 8 hex digits"));
  EXPECT_THAT(said_of("3"), ::testing::HasSubstr(":1: not a file of safety limits"));
}

}  // namespace lf::config
