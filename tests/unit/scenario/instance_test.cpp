#include "host_sim/scenario/instance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/mission/look.hpp"
#include "hal/config/text_file.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/scenario/scenario_file.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::scenario {

namespace {

std::string refusal(const Scenario& scenario) {
  try {
    (void)make_nominal(scenario, false);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace

TEST(Nominal, TheCameraLooksWhereItsAnglesSay) {
  const Pose pose = config::base_from_camera(Camera());
  EXPECT_LT((pose.linear().col(2) - Vec3(0.678, 0.257, 0.688)).norm(), 1e-3) << "the survey's axis";
  EXPECT_NEAR(pose.linear().col(0).z(), 0, 1e-12) << "no roll";
  EXPECT_NEAR((pose.linear() * pose.linear().transpose() - Mat3::Identity()).norm(), 0, 1e-12);
  EXPECT_GT(pose.linear().determinant(), 0);
}

// A lab's own profile is simulated as the make that it is like, however far up.
TEST(Truth, AProfileOfTheUsersOwnIsSimulatedAsTheOneItIsLike) {
  const test::TemporaryFolder folder;
  folder.write("ours.yaml", "title: ours\nlike: epos4_configured\n");
  folder.write("deep.yaml", "title: deep\nlike: ours\n");
  for (const std::string name : {"ours.yaml", "deep.yaml"}) {
    const Scenario scenario = load_scenario(folder.write("s.yaml", "drives: {profile: " + name + "}\n"));
    const hal::SimConfig config = make_truth(scenario, draw(scenario, 1), make_nominal(scenario, true), 1);
    ASSERT_NE(config.devices.drives[2].habit, nullptr) << name;
    EXPECT_STREQ(config.devices.drives[2].habit->name, "epos4_configured") << name;
  }
}

// It answered with its make's own numbers, and the boot refused the wrong device.
TEST(Truth, ASimulatedDriveHasTheIdentityOfItsProfile) {
  const test::TemporaryFolder folder;
  folder.write("ours.yaml", "title: ours\nlike: epos4\nidentity: {vendor: \"0x00001234\", product: \"0x00005678\"}\n");
  folder.write("plain.yaml", "title: plain\nlike: cia402\nidentity: {vendor: \"0x00001234\", product: \"0x00005678\"}\n");
  for (const std::string name : {"ours.yaml", "plain.yaml"}) {
    const Scenario scenario = load_scenario(folder.write("s.yaml", "drives: {profile: " + name + "}\n"));
    const hal::SimConfig config = make_truth(scenario, draw(scenario, 1), make_nominal(scenario, true), 1);
    EXPECT_EQ(config.devices.drives[2].vendor, 0x1234u) << name;
    EXPECT_EQ(config.devices.drives[2].product, 0x5678u) << name;
  }
}

TEST(Faults, ANodeThatIsNoneIsNamedWithTheNearest) {
  const config::Drives drives;
  Fault fault;
  fault.kind = "wrong_identity";
  const auto said = [&](const std::string& node) -> std::string {
    fault.node = node;
    try {
      (void)device_fault(fault, drives, {});
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(said("elbow"), "");
  EXPECT_EQ(said("elbw"), "no node 'elbw'; did you mean 'elbow'?");
  EXPECT_EQ(said("propeller"), "no node 'propeller'; there are the joints, io and master");
}

TEST(Overheard, ADriveOfAnotherMakeIsRefusedWithWhatToDo) {
  const Scenario scenario = load_scenario("default", {"drives.elbow.profile=c5e"});
  EXPECT_NO_THROW(check_overheard(scenario.drives, {}, 1));
  const std::string said = test::message_of<InputError>([&] { check_overheard(scenario.drives, {}, 2); });
  EXPECT_THAT(said, testing::HasSubstr("'drives.elbow.profile' cia402"));
  EXPECT_THAT(said, testing::HasSubstr("serve the node (`--nodes`)"));
}

// A shipped profile that is like another had no simulated drive, and its copy in a file had one.
TEST(Truth, AShippedProfileIsSimulatedAsTheOneItIsLike) {
  const Scenario scenario = load_scenario("default", {"drives.profile=ipos4808"});
  const hal::SimConfig config = make_truth(scenario, draw(scenario, 1), make_nominal(scenario, true), 1);
  ASSERT_NE(config.devices.drives[2].habit, nullptr);
  EXPECT_STREQ(config.devices.drives[2].habit->name, "ipos");
}

// A drive whose rating is configured says nothing against it.
TEST(Truth, ARatingThatTheSimulatedDriveDoesNotSayIsRefusedByName) {
  const double said_nm =
      make_truth(load_scenario("default"), draw(load_scenario("default"), 1), make_nominal(load_scenario("default"), true), 1)
          .devices.drives[2]
          .rated_torque_nm;
  const auto refused = [&](double share, const std::string& profile) -> std::string {
    const std::vector<std::string> set{"drives.elbow.rated_torque_nm=" + std::to_string(share * said_nm),
                                       "drives.elbow.profile=" + profile};
    try {
      check_runnable(load_scenario("default", set));
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refused(1.09, "lanternfish"), "");
  EXPECT_EQ(refused(0.92, "lanternfish"), "");
  for (const double share : {0.9, 1.12, 2.0})
    EXPECT_THAT(refused(share, "lanternfish"), testing::HasSubstr("'drives.elbow.rated_torque_nm'"));
  EXPECT_EQ(refused(2, "cia402_rated"), "");
}

// The machine is not its calibration: what the core is told stays, and what is true goes off by what was drawn.
TEST(Truth, TheMachineIsOffItsCalibrationByWhatWasDrawn) {
  const Scenario scenario =
      load_scenario("default", {"calibration.principal_point_px=0.3", "calibration.focal_percent=0.05", "calibration.distortion_px=0.3",
                                "calibration.lens_percent=20", "calibration.laser_cone_mrad=5", "calibration.beam_percent=-20",
                                "calibration.buttons_m=0.0004", "calibration.exposure_delay_ms=0.3", "camera.blur_px=1",
                                "mounting.laser_deg=0", "mounting.laser_m=0"});
  const Nominal told = make_nominal(scenario, false);
  const hal::SimConfig truth = make_truth(scenario, draw(scenario, 1), told, 1);
  const CameraIntrinsics& k = told.controller.camera.intrinsics;
  const optics::CameraConfig& camera = truth.optics.cameras[0];
  EXPECT_NEAR(camera.intrinsics.cx, k.cx + 0.3, 1e-9);
  EXPECT_NEAR(camera.intrinsics.cy, k.cy + 0.3, 1e-9);
  EXPECT_NEAR(camera.intrinsics.fx, k.fx * 1.0005, 1e-9);
  EXPECT_NEAR(camera.blur_px, 1.2, 1e-9);
  // Each of the three terms by itself moves the image at the corner by 0.3 px: along the radius k1, and p1 and p2 together by no more than their sum.
  const CameraIntrinsics& t = camera.intrinsics;
  const Vec2 corner(-t.cx / t.fx, -t.cy / t.fy);
  const double r2 = corner.squaredNorm();
  EXPECT_NEAR(std::abs(t.distortion[0] - k.distortion[0]) * r2 * corner.norm() * t.fx, 0.3, 0.01);
  const double p1 = t.distortion[2] - k.distortion[2], p2 = t.distortion[3] - k.distortion[3];
  const Vec2 by_p1(2 * p1 * corner.x() * corner.y(), p1 * (r2 + 2 * corner.y() * corner.y()));
  const Vec2 by_p2(p2 * (r2 + 2 * corner.x() * corner.x()), 2 * p2 * corner.x() * corner.y());
  for (const Vec2& shift : {by_p1, by_p2}) {
    EXPECT_LT(shift.norm() * t.fx, 0.31);
    EXPECT_GT(shift.norm() * t.fx, 0.1);
  }
  // The sheet's bow: its middle lies where the plane's does.
  const optics::LaserConfig& laser = truth.optics.lasers[0];
  EXPECT_NEAR(laser.cone_rad, 0.005, 1e-12);
  const Vec3 middle = laser.body_from_laser.linear() * Vec3(std::sin(laser.cone_rad), 0, std::cos(laser.cone_rad));
  const Scenario plain = load_scenario("default", {"calibration.laser_cone_mrad=0", "mounting.laser_deg=0", "mounting.laser_m=0"});
  const hal::SimConfig flat = make_truth(plain, draw(plain, 1), make_nominal(plain, false), 1);
  EXPECT_LT((middle - flat.optics.lasers[0].body_from_laser.linear().col(2)).norm(), 1e-9);
  EXPECT_NEAR(laser.waist_sigma_m, 0.8 * scenario.laser.waist_sigma_m, 1e-12);
  for (std::size_t i = 0; i < scenario.panel.buttons.size(); ++i)
    EXPECT_LT((truth.world.layout.buttons[i].at_m - scenario.panel.buttons[i].at_m - Vec2(0.0004, 0.0004)).norm(), 1e-12);
  EXPECT_EQ(truth.exposure_delay, Duration::from_us(300));
}

// Light, lens, sensor, laser and panel of one machine: what the core is told of them, if anything, stays.
TEST(Truth, LightAndPanelAreThoseThatWereDrawn) {
  const Scenario scenario = load_scenario("default", {"water.scattering_percent=20",
                                                      "water.phase_percent=-30",
                                                      "camera.corner_blur=1.8",
                                                      "camera.electrons_per_grey=25",
                                                      "camera.exposure_jitter=0.004",
                                                      "camera.ghost_share=0.001",
                                                      "camera.ghost_px=9",
                                                      "laser.speckle=0.2",
                                                      "laser.waist_at_m=0.1",
                                                      "laser.lobe_share=0.02",
                                                      "laser.lobe_sigmas=2.5",
                                                      "laser.lobe_ahead=false",
                                                      "laser.fan_low_percent=15",
                                                      "laser.fan_fine_percent=5",
                                                      "calibration.handle_m=0.0004",
                                                      "calibration.button_size_m=0.0003",
                                                      "calibration.marker_size_m=0.0002",
                                                      "calibration.marker_flat_m=0.0003",
                                                      "calibration.stamp_ms=-0.2",
                                                      "mounting.marker_m=0",
                                                      "mounting.marker_deg=0"});
  const Nominal told = make_nominal(scenario, false);
  const hal::SimConfig truth = make_truth(scenario, draw(scenario, 1), told, 1);
  const optics::WaterConfig& water = truth.optics.water;
  EXPECT_NEAR(water.scattering_ratio, 1.2, 1e-12);
  EXPECT_NEAR(water.back_share, 0.7 * optics::WaterConfig{}.back_share, 1e-12);
  // All shares alike: their sum holds them where they were.
  EXPECT_NEAR(water.forward.core, optics::ForwardScatter{}.core, 1e-6);
  const optics::CameraConfig& camera = truth.optics.cameras[0];
  EXPECT_EQ(camera.corner_blur, 1.8);
  EXPECT_EQ(camera.electrons_per_grey, 25);
  EXPECT_EQ(camera.exposure_jitter, 0.004);
  EXPECT_EQ(camera.ghost_share, 0.001);
  EXPECT_EQ(camera.ghost_px, 9);
  const optics::LaserConfig& laser = truth.optics.lasers[0];
  EXPECT_EQ(laser.speckle, 0.2);
  EXPECT_EQ(laser.waist_at_m, 0.1);
  EXPECT_EQ(laser.lobe_share, 0.02);
  EXPECT_EQ(laser.lobe_sigmas, -2.5);
  double mean = 0, greatest = 0;
  for (const float power : laser.fan_profile) {
    mean += double(power) / static_cast<double>(laser.fan_profile.size());
    greatest = std::max(greatest, std::abs(double(power) - 1));
  }
  EXPECT_NEAR(mean, 1, 1e-5) << "the power is the same";
  EXPECT_LE(greatest, 0.2 + 1e-6);
  EXPECT_GE(greatest, 0.15 - 0.05 - 1e-6);
  EXPECT_EQ(truth.stamp_offset, Duration::from_us(-200));
  // The panel as it was built, in the world and in the picture; the core and its vision have the drawing's.
  const PanelLayout& built = truth.world.layout;
  EXPECT_NEAR(built.valves[0].handle_length_m, scenario.panel.valves[0].handle_length_m + 0.0004, 1e-12);
  EXPECT_NEAR(built.valves[0].handle_thickness_m, scenario.panel.valves[0].handle_thickness_m + 0.0004, 1e-12);
  EXPECT_NEAR(built.valves[0].handle_height_m, scenario.panel.valves[0].handle_height_m + 0.0004, 1e-12);
  EXPECT_NEAR(built.buttons[0].width_m, scenario.panel.buttons[0].width_m + 0.0003, 1e-12);
  EXPECT_NEAR(built.buttons[0].height_m, scenario.panel.buttons[0].height_m + 0.0003, 1e-12);
  EXPECT_EQ(truth.vision.panel.valves[0].handle_length_m, scenario.panel.valves[0].handle_length_m);
  const std::vector<scene::Shape>& shapes = truth.optics.scene[arm5e_body::panel].shapes;
  const auto marker = std::find_if(shapes.begin(), shapes.end(), [](const scene::Shape& shape) { return shape.marker_id >= 0; });
  ASSERT_NE(marker, shapes.end());
  EXPECT_NEAR(marker->marker_size_m, scenario.panel.markers[0].size_m + 0.0002, 1e-12);
  // The plate's back: one corner lies on the panel, the opposite one stands off by both edges' share.
  double lowest = 1, highest = -1;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      const Vec3 corner = marker->body_from_shape * Vec3(x * marker->size_m.x(), y * marker->size_m.y(), -0.5 * marker->size_m.z());
      lowest = std::min(lowest, corner.z()), highest = std::max(highest, corner.z());
    }
  }
  EXPECT_NEAR(lowest, 0, 1e-6);
  EXPECT_NEAR(highest, 0.0006, 1e-6);
}

// The machine's truth is not the core's model: no seed has the very mixture of the core's haze, nor the electrons that its fit weighs by.
TEST(Truth, OfNoSeedIsTheCoresModel) {
  const Scenario scenario = load_scenario("default");
  const Nominal told = make_nominal(scenario, false);
  int farther = 0, fewer = 0, ahead = 0;
  constexpr int seeds = 60;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const hal::SimConfig truth = make_truth(scenario, draw(scenario, seed), told, 1);
    const optics::ForwardScatter& forward = truth.optics.water.forward;
    EXPECT_NEAR(forward.sum(), optics::ForwardScatter{}.sum(), 1e-5) << seed;
    double off = 0;
    for (std::size_t i = 0; i < forward.terms.size(); ++i) {
      const double nominal = double(optics::ForwardScatter{}.terms[i].weight), ratio = double(forward.terms[i].weight) / nominal;
      off = std::max(off, std::abs(ratio - 1));
      EXPECT_GT(ratio, 0.7 / 1.3) << seed;
      EXPECT_LT(ratio, 1.3 / 0.7) << seed;
    }
    EXPECT_GT(off, 0.01) << seed;
    farther += forward.terms[2].weight > optics::ForwardScatter{}.terms[2].weight ? 1 : 0;
    EXPECT_GE(truth.optics.cameras[0].electrons_per_grey, 20) << seed;
    EXPECT_LE(truth.optics.cameras[0].electrons_per_grey, 80) << seed;
    fewer += truth.optics.cameras[0].electrons_per_grey < 40 ? 1 : 0;
    ahead += truth.optics.lasers[0].lobe_sigmas > 0 ? 1 : 0;
  }
  // Both ways, each within four standard deviations of a coin's, or of a third's.
  EXPECT_NEAR(farther, seeds / 2, 4 * std::sqrt(seeds / 4.0));
  EXPECT_NEAR(ahead, seeds / 2, 4 * std::sqrt(seeds / 4.0));
  EXPECT_NEAR(fewer, seeds / 3, 4 * std::sqrt(seeds * 2 / 9.0));
}

TEST(Nominal, EveryShippedScenarioCanBeRun) {
  for (const ShippedScenario& shipped : shipped_scenarios()) EXPECT_EQ(refusal(load_scenario(shipped.name)), "") << shipped.name;
}

TEST(Nominal, DrivesAreSetUpWithinTheSafetyLimits) {
  const Nominal nominal = make_nominal(load_scenario("default"), true);
  std::size_t offender = 0;
  EXPECT_EQ(canopen::check(nominal.controller.network, offender), canopen::ConfigError::none) << "drive " << offender;
  EXPECT_TRUE(nominal.controller.mission.use_lamps);
}

TEST(Nominal, AnUnreachableValveIsRefusedWithTheLimitThatStopsIt) {
  const std::string far =
      refusal(load_scenario("default", {"panel.ahead_m=0.69", "panel.right_m=0.39", "camera.position_m=[0.2, 0.145, 0.06]"}));
  EXPECT_THAT(far, ::testing::HasSubstr("the valve is out of the arm's reach at its nominal place: "));
  EXPECT_THAT(far, ::testing::HasSubstr(" by "));
}

TEST(Nominal, AnExposureOverWhichTheLaserWouldSwitchIsRefused) {
  EXPECT_THAT(refusal(load_scenario("default", {"mission.camera_syncs=2", "camera.exposure_us=4001"})),
              ::testing::HasSubstr("an exposure lasts at most 4000 us"));
  EXPECT_EQ(refusal(load_scenario("default", {"mission.camera_syncs=2", "camera.exposure_us=4000"})), "");
}

TEST(Nominal, AVehicleOfNoExtentOrOfTooManyPartsIsRefused) {
  const auto refused = [](const std::string& set) {
    try {
      (void)load_scenario("default", {set});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused("vehicle.boxes_m=[[0, 0, 0, 1, 0, 1]]"),
              ::testing::HasSubstr("has 0 for the 5th of these 6 numbers: it has to be above 0"));
  EXPECT_THAT(refused("vehicle.capsules_m=[[0, 0, 0, 1, 0, 1, 0]]"), ::testing::HasSubstr("has 0 for the 7th of these 7 numbers"));
  std::string many = "[[-4, 0, 0, 1, 1, 1]";
  for (std::size_t i = 0; i < arm::VehicleShape::capacity; ++i) many += ", [-4, 0, 0, 1, 1, 1]";
  EXPECT_THAT(refusal(load_scenario("default", {"vehicle.boxes_m=" + many + "]"})), ::testing::HasSubstr("more than 16 boxes"));
}

// A mission would end before its first look: the sweep begins above the panel wherever it may stand, and the arm lifts the line only so far.
TEST(Nominal, ADockingAtWhichTheLaserDoesNotPassOverThePanelIsRefused) {
  Scenario scenario = load_scenario("default", {"mission.docking_m=0.025", "mission.docking_rad=0.05"});
  EXPECT_EQ(refusal(scenario), "");
  scenario.mission.docking.shift_m = 0.05;
  EXPECT_THAT(refusal(scenario), ::testing::HasSubstr("the laser cannot be swept over the whole panel wherever it may stand with "
                                                      "'mission.docking_m' at 0.05 and 'mission.docking_rad' at 0.05: "));
  EXPECT_THAT(refusal(scenario), ::testing::HasSubstr(". 'panel.ahead_m' is 0.44"));
}

// A panel that may stand where the arm is folded up: the refusal says which part of it.
TEST(Nominal, APanelThatMayStandWhereTheArmIsIsNamed) {
  Scenario scenario = load_scenario("default");
  scenario.mission.docking.shift_m = 0.3;
  EXPECT_THAT(refusal(scenario), ::testing::ContainsRegex("folded up the arm comes as near as [0-9]+ mm to the panel's [a-z ]+, with "
                                                          "'mission.docking_m' at 0.3"));
}

TEST(Nominal, WhatStandsInTheWayOfTheFirstSweepIsNamed) {
  const auto with_ball_at = [](const arm::JointVector& q_rad) {
    const Vec3 tool = test::arm5e.base_from_tool(q_rad).translation();
    const std::string place = std::to_string(tool.x()) + ", " + std::to_string(tool.y()) + ", " + std::to_string(tool.z());
    return load_scenario("default", {"vehicle.capsules_m=[[-2, 0, 0, -2, 0, 0, 0.1], [" + place + ", " + place + ", 0.02]]"});
  };
  const Nominal nominal = make_nominal(load_scenario("default"), true);
  const mission::MissionConfig& mission = nominal.controller.mission;
  EXPECT_THAT(refusal(with_ball_at(mission.park_rad)),
              ::testing::HasSubstr("folded up the arm comes as near as 0 mm to capsule 2 of 'vehicle.capsules_m'"));
  const scan::SweepPlan plan = scan::plan_sweep(test::arm5e, mission::sweep_over_panel(mission), nominal.controller.laser);
  const auto& start = plan.start_rad;
  EXPECT_THAT(refusal(with_ball_at(arm::planar_joints(start[0], start[1], start[2], start[3]))),
              ::testing::HasSubstr("sweeping the laser over the panel the arm comes as near as 0 mm to capsule 2 of 'vehicle.capsules_m'"));
  EXPECT_THAT(refusal(load_scenario("default", {"vehicle.boxes_m=[[-2, 0, 0, 0.1, 0.1, 0.1], [0, 0, 0.3, 0.2, 0.2, 0.2]]"})),
              ::testing::HasSubstr("to box 2 of 'vehicle.boxes_m', at [0, 0, 0.3]"));
}

TEST(Nominal, ACloudThinsItsColumnsWhereTheCameraIsFaster) {
  const auto apart = [](const char* syncs) {
    return make_nominal(load_scenario("default", {std::string("mission.camera_syncs=") + syncs}), false).scan.columns_apart;
  };
  EXPECT_EQ(apart("2"), 5u);
  EXPECT_EQ(apart("8"), 2u);
  EXPECT_EQ(apart("9"), 1u);
  EXPECT_EQ(apart("20"), 1u);
  EXPECT_NEAR(make_nominal(load_scenario("default"), false).scan.silhouette_margin_m, 0.010, 1e-12);
}

TEST(Nominal, APanelOutOfViewIsRefused) {
  EXPECT_THAT(refusal(load_scenario("default", {"camera.down_deg=-30"})), ::testing::HasSubstr("out of the camera's view"));
  EXPECT_THAT(refusal(load_scenario("default", {"camera.right_deg=180"})), ::testing::HasSubstr("is behind the camera"));
  EXPECT_THAT(refusal(load_scenario("default", {"camera.focal_px=800"})),
              ::testing::HasSubstr(": see 'camera.position_m', 'camera.down_deg', 'camera.right_deg', 'camera.focal_px', "
                                   "'camera.distortion' and 'panel.plate_min_m'. 'panel.ahead_m' is 0.44, 'panel.right_m' 0, "
                                   "'panel.down_m' 0.592"));
}

TEST(Nominal, AMissingOrBadUrdfIsRefused) {
  EXPECT_THAT(refusal(load_scenario("default", {"arm.urdf=no_such_arm.urdf"})), ::testing::HasSubstr("no_such_arm.urdf"));
  const ScenarioFile urdf("<robot name=\"x\"/>\n", ".urdf");
  EXPECT_THAT(refusal(load_scenario("default", {"arm.urdf=" + urdf.path()})), ::testing::HasSubstr(urdf.path()));
}

TEST(Truth, HasTheSamplesErrorsAndTheCoreHasNone) {
  const Scenario scenario = load_scenario("default");
  const Sample sample = draw(scenario, 3);
  const Nominal nominal = make_nominal(scenario, sample.lamps_lit);
  const hal::SimConfig truth = make_truth(scenario, sample, nominal, 1);
  const Pose nominal_panel = nominal.controller.mission.layout.nominal_base_from_panel();
  EXPECT_LT((truth.world.base_from_panel.translation() - nominal_panel.translation() - sample.docking_shift_m).norm(), 1e-12);
  const double turn = Eigen::AngleAxisd(truth.world.base_from_panel.linear() * nominal_panel.linear().transpose()).angle();
  EXPECT_NEAR(turn, sample.docking_turn_rad.norm(), 0.03 * sample.docking_turn_rad.norm() + 1e-9)
      << "small turns about three axes nearly add up";
  EXPECT_EQ(truth.world.valves[0].friction_nm, sample.valves[0].friction_nm);
  EXPECT_EQ(truth.optics.water.attenuation_per_m, sample.attenuation_per_m);
  const Pose camera_error = nominal.controller.camera.base_from_camera.inverse() * truth.optics.cameras[0].base_from_camera;
  EXPECT_LT((camera_error.translation() - sample.camera_shift_m).norm(), 1e-12);
  EXPECT_GT(sample.camera_shift_m.norm(), 1e-6) << "otherwise this test says nothing";
}

TEST(Truth, OfAFilesPanelHasItsFeaturesUnderTheirNames) {
  const Scenario scenario = load_scenario(
      "default", {"panel.file=pandora",
                  "tasks=[{press_buttons: {order: [B1]}}, {turn_valve: {valve: V2, to_deg: 10}}, {turn_valve: {valve: V1, to_deg: 10}}]",
                  "buttons.stuck=[B2]", "buttons.missing=[B1]"});
  const Sample sample = draw(scenario, 3);
  const Nominal nominal = make_nominal(scenario, false);
  const hal::SimConfig truth = make_truth(scenario, sample, nominal, 1);
  ASSERT_EQ(truth.world.valves.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(truth.world.valves[i].start_rad, sample.valves[i].start_rad);
    EXPECT_EQ(truth.world.valves[i].friction_nm, sample.valves[i].friction_nm);
  }
  EXPECT_EQ(truth.valve_that_breaks, 1u) << "the first that is to be turned";
  ASSERT_EQ(truth.world.buttons.size(), 2u);
  EXPECT_FALSE(truth.world.buttons[0].stuck);
  EXPECT_TRUE(truth.world.buttons[1].stuck);
  const scene::Scene& scene = truth.world.scene;
  const std::vector<std::size_t> handles = scene::bodies_of(scene, scene::Role::handle),
                                 caps = scene::bodies_of(scene, scene::Role::button);
  ASSERT_EQ(handles.size(), 4u);
  ASSERT_EQ(caps.size(), 2u);
  EXPECT_EQ(scene[handles[1]].name, "V2's handle");
  EXPECT_TRUE(scene[caps[0]].shapes.empty()) << "broken off";
  EXPECT_FALSE(scene[caps[1]].shapes.empty());
  ASSERT_EQ(nominal.controller.markers.size(), 2u);
  EXPECT_EQ(nominal.controller.markers[1].id, 12);
  EXPECT_EQ(nominal.controller.mission.tasks[1].valve, 1);
  const std::vector<scene::Shape>& panel = scene[arm5e_body::panel].shapes;
  EXPECT_EQ(std::count_if(panel.begin(), panel.end(), [](const scene::Shape& shape) { return shape.marker_id >= 0; }), 2);
}

// The core's own model of a gear is the description's, whatever the truth is.
TEST(Truth, HasGearsOfWhichTheCoreKnowsLess) {
  const auto drives_of = [](const std::vector<std::string>& overrides, Nominal& nominal) {
    const Scenario scenario = load_scenario("default", overrides);
    const Sample sample = draw(scenario, 1);
    nominal = make_nominal(scenario, sample.lamps_lit);
    return make_truth(scenario, sample, nominal, 1).devices.drives;
  };
  Nominal told, plainly_told;
  const auto drives = drives_of({"friction.breakaway=1.5", "friction.one_way=0.2", "friction.pivot_m=0.0003"}, told);
  const auto plain = drives_of({"friction.breakaway=1", "friction.one_way=0", "friction.pivot_m=0"}, plainly_told);
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    EXPECT_EQ(drives[i].friction.breakaway, 1.5);
    EXPECT_EQ(drives[i].friction.one_way, 0.2);
    const bool has_screw = plain[i].actuator.pivot_a_m > 0;
    EXPECT_NEAR(drives[i].actuator.pivot_a_m - plain[i].actuator.pivot_a_m, has_screw ? 0.0003 : 0, 1e-12);
    EXPECT_EQ(told.controller.transmissions[i].friction.coulomb_nm, plainly_told.controller.transmissions[i].friction.coulomb_nm);
  }
  EXPECT_GT(plain[1].actuator.pivot_a_m, 0) << "otherwise this test says nothing";
}

TEST(Truth, WithoutErrorsTheWorldIsAsTheCoreIsTold) {
  const Scenario scenario =
      load_scenario("default", {"docking.x_m=0", "docking.y_m=0", "docking.z_m=0", "docking.roll_deg=0", "docking.pitch_deg=0",
                                "docking.yaw_deg=0", "mounting.camera_m=0", "mounting.camera_deg=0", "mounting.laser_m=0",
                                "mounting.laser_deg=0", "mounting.joints_deg=0", "mounting.marker_m=0", "mounting.marker_deg=0"});
  const Sample sample = draw(scenario, 1);
  const Nominal nominal = make_nominal(scenario, false);
  const hal::SimConfig truth = make_truth(scenario, sample, nominal, 1);
  EXPECT_TRUE(truth.world.base_from_panel.isApprox(scenario.panel.nominal_base_from_panel(), 1e-15));
  EXPECT_TRUE(truth.optics.cameras[0].base_from_camera.isApprox(nominal.controller.camera.base_from_camera, 1e-15));
}

// The laser as the simulator mounts it on the forearm, against the core's kinematics with the nominal calibration: two ways to one pose.
TEST(Truth, TheLaserOnTheForearmIsWhereTheCoreThinksItIs) {
  const Scenario scenario = load_scenario("default", {"mounting.laser_m=0", "mounting.laser_deg=0", "calibration.laser_cone_mrad=0"});
  const Nominal nominal = make_nominal(scenario, false);
  const hal::SimConfig truth = make_truth(scenario, draw(scenario, 1), nominal, 1);
  for (const arm::JointVector& q_rad : {arm::planar_joints(0, 0.945, 2.095, 0), arm::planar_joints(-0.3, 0.6, 1.2, 1.0)}) {
    const Pose base_from_forearm = test::arm5e.base_from_links(q_rad, 0)[2];
    const Pose base_from_laser = test::arm5e.base_from_laser(q_rad, nominal.controller.laser);
    EXPECT_LT(((base_from_forearm * truth.optics.lasers[0].body_from_laser).matrix() - base_from_laser.matrix()).norm(), 1e-6);
  }
}

TEST(Truth, FaultsReachTheirNodes) {
  const Scenario scenario = load_scenario("drive_fault");
  const hal::SimConfig truth = make_truth(scenario, draw(scenario, 1), make_nominal(scenario, false), 1);
  ASSERT_EQ(truth.devices.faults.size(), 1u);
  EXPECT_EQ(truth.devices.faults[0].node, can_map::drive_nodes[arm5e_joint::elbow]);
  EXPECT_EQ(truth.devices.faults[0].kind, devices::DeviceFaultKind::overcurrent);
}

}  // namespace lf::scenario
