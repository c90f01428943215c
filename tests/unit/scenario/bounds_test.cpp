// What other keys leave of a key's range: its ends are accepted, and what lies a little beyond is refused.
#include "host_sim/scenario/bounds.hpp"

#include <gtest/gtest.h>

#include "hal/config/share.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/keys.hpp"
#include "shared/input_error.hpp"

namespace lf::scenario {
namespace {

Bounds bounds_of(const std::string& path) {
  Scenario scenario;
  const ArmDescription arm = load_arm_urdf(config::find_file(scenario.arm.urdf, ""));
  for (const config::Key& key : keys(scenario)) {
    if (key.path == path) return scenario::bounds_of(key, scenario, arm);
  }
  ADD_FAILURE() << path;
  return {};
}

bool accepted(const std::string& path, double value) {
  try {
    check_runnable(load_scenario("default", {path + "=" + std::to_string(value)}));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

struct Case {
  const char* path;
  bool below = false, above = false;  // is bounded by another key there
};

class BoundsTest : public testing::TestWithParam<Case> {};

TEST_P(BoundsTest, BothEndsAreAcceptedAndBeyondIsRefused) {
  const Case& of = GetParam();
  const auto [min, max] = bounds_of(of.path);
  ASSERT_LT(min, max);
  const double inside = 1e-4 * (max - min), beyond = 0.03 * (max - min);
  EXPECT_TRUE(accepted(of.path, min + inside)) << min;
  EXPECT_TRUE(accepted(of.path, max - inside)) << max;
  EXPECT_TRUE(accepted(of.path, 0.5 * (min + max)));
  EXPECT_TRUE(!of.below || !accepted(of.path, min - beyond)) << min;
  EXPECT_TRUE(!of.above || !accepted(of.path, max + beyond)) << max;
}

INSTANTIATE_TEST_SUITE_P(Keys, BoundsTest,
                         testing::Values(Case{"valve.start_deg", true, true}, Case{"valve.stop_min_deg", false, true},
                                         Case{"valve.stop_max_deg", true, false}, Case{"buttons.preload_n", false, true},
                                         Case{"buttons.spring_n_m", false, true}, Case{"buttons.click_depth_m", true, true},
                                         Case{"buttons.release_depth_m", false, true}, Case{"buttons.click_drop_n", false, true},
                                         Case{"panel.marker_size_m", false, true}, Case{"panel.marker_plate_m", true, false},
                                         Case{"panel.handle_thickness_m", true, false}, Case{"panel.pointer_length_m", false, true},
                                         Case{"panel.button_stroke_m", true, true}, Case{"panel.button_height_m", true, false},
                                         Case{"latency.image_ms", false, true}, Case{"latency.panel_vision_ms", false, true},
                                         Case{"jaw.torque_nm", true, false}, Case{"mission.press_torque_nm", true, false}),
                         [](const auto& each) {
                           std::string name = each.param.path;
                           for (char& letter : name) letter = letter == '.' ? '_' : letter;
                           return name;
                         });

}  // namespace
}  // namespace lf::scenario
