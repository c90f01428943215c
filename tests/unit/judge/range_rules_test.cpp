// Reasons as runs gave them when a key was drawn over its range.
#include "host_sim/judge/range_rules.hpp"

#include <gtest/gtest.h>

#include <set>

#include "firmware/mission/step_failure.hpp"
#include "host_sim/scenario/keys.hpp"

namespace lf::judge {
namespace {

TEST(RangeRules, AReasonNamesTheKeyThatItCameOf) {
  EXPECT_TRUE(names_a_key({"water.ambient"}, "panel vision unsure: too few points of the panel"));
  EXPECT_TRUE(names_a_key({"lamps.power"}, "panel vision unsure: the handle's pointer mark was not recognised"));
  EXPECT_TRUE(names_a_key({"valve.friction_nm"}, "step failed: the turn stalled (The valve is stiff.)"));
  EXPECT_TRUE(names_a_key({"mounting.joints_deg"}, "step failed: the button gives way without bottoming"));
  EXPECT_TRUE(names_a_key({"mission.press_torque_nm"}, "overload: elbow, in step press"));
  EXPECT_TRUE(names_a_key({"drives.elbow.rated_torque_nm"}, "boot failed: elbow, in step boot; elbow"));
}

TEST(RangeRules, AReasonThatNamesAnotherCauseDoesNot) {
  EXPECT_FALSE(names_a_key({"water.ambient"}, "overload: elbow, in step press"));
  EXPECT_FALSE(names_a_key({"drives.elbow.rated_torque_nm"}, "boot failed: slew, in step boot; slew"));
  EXPECT_FALSE(names_a_key({"mission.approach_speed_m_s"}, "not ended by the time limit of 400 s, at 400.0 s"));
  EXPECT_FALSE(names_a_key({"friction.coulomb"}, "panel vision unsure: no panel seen"));
  // The name of the step is no cause.
  EXPECT_FALSE(names_a_key({"valve.friction_nm"}, "overload: slew, in step turn"));
  EXPECT_FALSE(names_a_key({"valve.friction_nm"}, "drive fault: jaw, in step reach valve"));
  EXPECT_FALSE(names_a_key({"buttons.spring_n_m"}, "following error: slew, in step press"));
  EXPECT_FALSE(names_a_key({"friction.coulomb"}, "camera silent, in step reach button"));
  EXPECT_FALSE(names_a_key({"camera.noise_grey"}, "overload: elbow (Look at the camera.)")) << "advice names nothing";
}

// Of each group one key, with the failures that are its own. Every other one is refused, whichever fault tells it.
TEST(RangeRules, OfTheFailuresOfALookOrStepOnlyTheKeysOwnNameIt) {
  using F = StepFailure;
  using Set = std::set<StepFailure>;
  const Set line{F::no_panel, F::too_few_points, F::plane_unsure, F::no_handle, F::handle_unsure};
  const Set touch{F::early_contact, F::no_contact,   F::not_gripped,    F::wrong_angle,  F::touched_on_the_way_back,
                  F::slipped,       F::button_stuck, F::button_missing, F::button_yields};
  const Set way{F::unreachable, F::no_motion, F::panel_in_the_way, F::vehicle_in_the_way, F::arm_in_its_own_way};
  const Set press{F::button_stuck, F::button_missing, F::button_yields, F::early_contact, F::touched_on_the_way_back};
  const Set bar{F::no_handle, F::handle_unsure, F::pointer_unsure, F::half_turn_open, F::beyond_stops};
  const Set turn{F::stalled, F::wrong_angle, F::slipped};
  const Set load{F::early_contact,           F::not_gripped, F::wrong_angle, F::jaw_stuck, F::jaw_not_closed,
                 F::touched_on_the_way_back, F::stalled,     F::slipped};
  const Set elsewhere{F::marker_wrong,   F::marker_disagrees, F::panel_moved, F::plane_unsure,    F::no_handle,
                      F::pointer_unsure, F::beyond_stops,     F::unreachable, F::panel_in_the_way};
  const auto all_of = [](std::initializer_list<Set> sets) {
    Set all;
    for (const Set& each : sets) all.insert(each.begin(), each.end());
    return all;
  };
  const std::vector<std::pair<const char*, Set>> own{
      {"tasks", all_of({turn, bar})},
      {"docking.z_m", all_of({touch, way, {F::no_marker, F::no_handle, F::panel_moved}})},
      {"valve.start_deg", all_of({turn, bar})},
      {"valve.stop_max_deg", all_of({turn, bar})},
      {"valve.friction_nm", turn},
      {"buttons.stuck", press},
      {"panel.ahead_m", all_of({line, touch, way, {F::no_marker, F::pointer_unsure}})},
      {"panel.plate_min_m", {F::no_panel, F::too_few_points, F::plane_unsure, F::panel_in_the_way, F::no_motion, F::unreachable}},
      {"panel.handle_thickness_m", all_of({bar, touch, way, {F::stalled, F::jaw_stuck, F::jaw_not_closed}})},
      {"panel.pointer", {F::pointer_unsure, F::half_turn_open, F::beyond_stops}},
      {"panel.button_width_m", all_of({press, way, {F::no_marker}})},
      {"panel.buttons_m", all_of({press, way, {F::no_marker}})},
      {"panel.marker_centre_m",
       all_of({touch, {F::no_marker, F::marker_wrong, F::marker_disagrees, F::panel_moved, F::panel_in_the_way, F::no_motion}})},
      {"panel.marker_plate_m",
       all_of({touch, {F::no_marker, F::marker_wrong, F::marker_disagrees, F::panel_moved, F::panel_in_the_way, F::no_motion}})},
      {"panel.marker_id", all_of({touch, {F::no_marker, F::marker_wrong, F::marker_disagrees, F::panel_moved}})},
      {"panel.marker_size_m", all_of({touch, {F::no_marker, F::marker_wrong, F::marker_disagrees, F::panel_moved}})},
      {"water.attenuation_per_m", all_of({line, {F::no_marker, F::pointer_unsure, F::line_misshapen}})},
      {"water.ambient", all_of({line, {F::no_marker, F::pointer_unsure, F::line_misshapen}})},
      {"water.particles_per_l", all_of({line, {F::no_marker, F::pointer_unsure}})},
      {"lamps.power", {F::no_marker, F::pointer_unsure}},
      {"camera.always_on", {F::too_few_points}},
      {"camera.noise_grey", all_of({line, {F::no_marker, F::pointer_unsure}})},
      {"camera.electrons_per_grey", all_of({line, {F::no_marker, F::pointer_unsure}})},
      {"camera.exposure_jitter", all_of({line, {F::no_marker, F::pointer_unsure}})},
      {"camera.exposure_us", all_of({line, {F::no_marker, F::pointer_unsure, F::line_misshapen}})},
      {"camera.blur_px", all_of({line, {F::no_marker, F::pointer_unsure, F::line_misshapen}})},
      {"camera.corner_blur", all_of({line, {F::no_marker, F::pointer_unsure, F::line_misshapen}})},
      {"camera.ghost_share", all_of({line, {F::line_misshapen}})},
      {"camera.down_deg",
       all_of({line, touch, {F::no_marker, F::pointer_unsure, F::marker_wrong, F::marker_disagrees, F::panel_moved, F::line_misshapen}})},
      {"laser.power_w", all_of({line, {F::line_misshapen}})},
      {"laser.position_m", all_of({line, way, {F::line_misshapen}})},
      {"sensors.seed", {}},
      {"mounting.joints_deg", all_of({elsewhere, touch})},
      {"calibration.focal_percent", all_of({elsewhere, touch})},
      {"calibration.lens_percent", {F::no_marker, F::pointer_unsure, F::line_misshapen, F::plane_unsure}},
      {"calibration.beam_percent", {F::line_misshapen, F::plane_unsure}},
      {"latency.image_ms", {F::no_panel, F::too_few_points, F::handle_unsure}},
      {"latency.panel_vision_ms", {}},
      {"vehicle.boxes_m", {F::vehicle_in_the_way, F::no_motion, F::unreachable}},
      {"jaw.torque_nm", load},
      {"physics.torque_noise_ratio", load},
      {"friction.coulomb", load},
      {"drives.profile", {}},
      {"drives.elbow.node", {}},
      {"outputs.node", {}},
      {"mission.docking_m", {F::panel_in_the_way, F::no_motion, F::unreachable}},
      {"mission.camera_syncs", line},
      {"mission.frames_per_background", all_of({line, {F::line_misshapen}})},
      {"mission.sweep_speed_rad_s", line},
      {"mission.verify_band_m", line},
      {"mission.press_torque_nm", press},
      {"mission.turn_speed_rad_s", turn},
      {"mission.valve_tolerance_rad", {F::wrong_angle}},
      {"mission.approach_distance_m", all_of({press, way, {F::no_contact, F::not_gripped}})},
      {"mission.move_speed_fraction", load},
      {"mission.tries", {F::no_handle, F::handle_unsure, F::pointer_unsure, F::not_gripped, F::slipped}},
  };
  for (const auto& [key, failures] : own) {
    for (auto code = static_cast<std::int32_t>(F::unreachable); code <= static_cast<std::int32_t>(F::line_misshapen); ++code) {
      const auto failure = static_cast<StepFailure>(code);
      ASSERT_STRNE(lf::name(failure), "unknown");
      for (const char* fault : {"step failed: ", "panel vision unsure: "}) {
        const std::string told = std::string(fault) + lf::name(failure) + " (" + lf::remedy(failure) + "), in step scan";
        EXPECT_EQ(names_a_key({key}, told), failures.contains(failure)) << key << ": " << told;
      }
    }
  }
}

// What the look saw is the deeper cause.
TEST(RangeRules, WhereALookSaysWhatItSawThatDecides) {
  const std::string dark = "panel vision unsure: no usable marker seen: the pictures are dark (The exposure is too short.), in step scan";
  EXPECT_TRUE(names_a_key({"camera.exposure_us"}, dark));
  EXPECT_TRUE(names_a_key({"lamps.power"}, dark));
  EXPECT_FALSE(names_a_key({"panel.marker_size_m"}, dark));
  EXPECT_FALSE(names_a_key({"camera.blur_px"}, dark));
  const std::string turbid = "panel vision unsure: no usable marker seen: the water is too turbid (The still picture shows no contrast.)";
  EXPECT_TRUE(names_a_key({"water.attenuation_per_m"}, turbid));
  EXPECT_FALSE(names_a_key({"docking.x_m"}, turbid));
  EXPECT_TRUE(names_a_key({"docking.x_m"},
                          "panel vision unsure: no usable marker seen: the marker is hidden or another one (Panel and handle ...)"))
      << "by the arm, where the panel stands elsewhere";
  EXPECT_FALSE(names_a_key({"laser.power_w"}, turbid));
  const std::string noisy = "panel vision unsure: no handle seen: the pictures are noisy: 30 grey levels (Give them more light.)";
  EXPECT_TRUE(names_a_key({"camera.noise_grey"}, noisy));
  EXPECT_FALSE(names_a_key({"panel.handle_thickness_m"}, noisy));
  const std::string off = "step failed: out of reach: the panel stands 70 mm off its nominal place (Dock again.), in step grip";
  EXPECT_TRUE(names_a_key({"docking.y_m"}, off));
  EXPECT_FALSE(names_a_key({"mission.approach_distance_m"}, off));
  const std::string small =
      "panel vision unsure: no usable marker seen: the marker is too small in the picture: 1.7 px a square of its code";
  EXPECT_TRUE(names_a_key({"panel.marker_size_m"}, small));
  EXPECT_TRUE(names_a_key({"camera.focal_px"}, small));
  EXPECT_FALSE(names_a_key({"water.attenuation_per_m"}, small));
  const std::string line = "panel vision unsure: no panel seen: the laser's line is missing or too weak (Check the laser's power.)";
  EXPECT_TRUE(names_a_key({"laser.power_w"}, line));
  EXPECT_FALSE(names_a_key({"lamps.power"}, line));
}

TEST(RangeRules, TheNameOfAFaultOfVisionNamesNoKey) {
  EXPECT_FALSE(names_a_key({"panel.handle_height_m"}, "panel vision unsure: the laser's line is misshapen"));
  EXPECT_FALSE(names_a_key({"water.ambient"}, "panel vision unsure: panel vision failed"));
  EXPECT_FALSE(names_a_key({"mounting.camera_deg"}, "panel vision late, in step scan"));
  EXPECT_TRUE(names_a_key({"latency.panel_vision_ms"}, "panel vision late, in step scan"));
  EXPECT_TRUE(names_a_key({"latency.image_ms"}, "camera silent, in step scan"));
  EXPECT_FALSE(names_a_key({"latency.panel_vision_ms"}, "camera silent, in step scan"));
  EXPECT_FALSE(names_a_key({"water.ambient"}, "camera silent, in step scan"));
}

TEST(RangeRules, OfSeveralKeysOneIsNamed) {
  EXPECT_TRUE(names_a_key({"friction.coulomb", "water.ambient"}, "panel vision unsure: no panel seen"));
  EXPECT_FALSE(names_a_key({"friction.coulomb", "buttons.spring_n_m"}, "panel vision unsure: no panel seen"));
}

TEST(RangeRules, EveryKeyThatIsDrawnHasItsWords) {
  scenario::Scenario scenario;
  for (const config::Key& key : scenario::keys(scenario)) {
    const bool not_drawn = key.path == "description" || key.path == "machine" || key.path == "time_limit_s" || key.path == "scene" ||
                           key.path == "faults" || key.path == "expect.failure" || key.path == "safety.limits" ||
                           key.path == "safety.mission_limits";
    EXPECT_EQ(words_for(key.path).empty(), not_drawn) << key.path;
  }
}

TEST(RangeRules, ARefusalNamesAKeyByItsPathOrByGroupAndLastPart) {
  EXPECT_TRUE(refusal_names_a_key({"camera.down_deg"}, "default.yaml: the marker is out of the camera's view: see 'camera.down_deg'."));
  EXPECT_TRUE(refusal_names_a_key({"drives.slew.counts_per_rev"}, "default.yaml: drives.slew: 'counts_per_rev' is 1e+06: too many"));
  EXPECT_TRUE(refusal_names_a_key({"drives.counts_per_rev"}, "default.yaml: drives.slew: 'counts_per_rev' is 1e+06: too many"));
  EXPECT_TRUE(refusal_names_a_key({"outputs.node"}, "default.yaml: drives.slew and outputs have the same node number, 1"));
  EXPECT_TRUE(refusal_names_a_key({"tasks"}, "default.yaml: 'turn_valve.to_deg' is 200, beyond the valve's stops at -190 and 100"));
  EXPECT_TRUE(refusal_names_a_key({"water.ambient", "panel.ahead_m"}, "out of reach. 'panel.ahead_m' is 0.7."));
}

TEST(RangeRules, ARefusalThatNamesAnotherKeyDoesNotCount) {
  EXPECT_FALSE(refusal_names_a_key({"camera.focal_px"}, "the marker is out of the camera's view: see 'camera.down_deg'"));
  EXPECT_FALSE(refusal_names_a_key({"drives.elbow.counts_per_rev"}, "default.yaml: drives.slew: 'counts_per_rev' is 1e+06: too many"));
  EXPECT_FALSE(refusal_names_a_key({"drives.counts_per_rev"}, "default.yaml: drives.slew: 'rated_torque_nm' is 12 N m"));
  EXPECT_FALSE(refusal_names_a_key({"panel.marker_size_m"}, "default.yaml: 'calibration.marker_size_m' is too large"));
  EXPECT_FALSE(refusal_names_a_key({"panel.right_m"}, "the laser cannot be swept over the whole panel"));
  EXPECT_FALSE(refusal_names_a_key({"tasks"}, "the arm does not reach these tasks"));
  EXPECT_FALSE(refusal_names_a_key({"water.ambient"}, ""));
}

}  // namespace
}  // namespace lf::judge
