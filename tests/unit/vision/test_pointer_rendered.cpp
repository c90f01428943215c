// The pointer in stills of the simulator: the whole circle, in clear and turbid water, by daylight and under lamps, docked askew.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "hal/vision/pointer.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/mission_scene.hpp"
#include "tests/unit/scan/docked_scene.hpp"

namespace lf::vision {
namespace {

struct Conditions {
  double attenuation_per_m = 0.1;
  double noise_grey = 1;
  bool lamps = false;
};

void PrintTo(const Conditions& c, std::ostream* out) {
  *out << c.attenuation_per_m << " /m, noise " << c.noise_grey << (c.lamps ? ", lamps" : ", daylight");
}

class RenderedPointer : public testing::TestWithParam<Conditions> {};

TEST_P(RenderedPointer, IsReadOverTheWholeCircle) {
  constexpr std::uint32_t seed = 815;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  const optics::test::MissionScene mission;
  optics::OpticsConfig config = mission.config();
  optics::CameraConfig& camera = config.cameras[0];
  camera.intrinsics = {};
  camera.read_noise_grey = GetParam().noise_grey;
  config.water.attenuation_per_m = GetParam().attenuation_per_m;
  optics::Optics optics(config);
  CameraCalibration calibration;
  calibration.intrinsics = camera.intrinsics;
  calibration.base_from_camera = camera.base_from_camera;

  double least = 1;
  for (int degrees = -180; degrees < 180; degrees += 15) {
    const double angle_rad = rad_from_deg(degrees + 7 * share(random));
    const Pose panel = lf::test::docked_panel(random, 0.020, rad_from_deg(2));
    optics::Shot shot;
    shot.frame_number = static_cast<std::uint64_t>(degrees + 180);
    shot.lamps = GetParam().lamps;
    shot.laser = false;
    shot.poses = mission.poses({0, 0.945, 0.92, 0, 0}, 0, 0);  // the sweep's end, where stills are taken
    for (std::size_t i = arm5e_body::panel; i < mission.scene.size(); ++i)
      shot.poses[i] = panel * mission.layout.nominal_base_from_panel().inverse() * shot.poses[i];
    shot.poses[arm5e_body::first_feature] = panel * Eigen::AngleAxisd(angle_rad, Vec3::UnitZ());
    optics::Frame frame;
    optics.render(shot, frame);

    BarPlace place;
    place.base_from_panel = panel;
    place.base_from_panel.translation() += 0.0015 * Vec3(share(random), share(random), share(random));
    place.angle_rad = wrap(angle_rad, pi / 2) + rad_from_deg(1) * share(random);
    const PointerObservation pointer =
        find_pointer(place, {frame.pixels.data(), frame.width, frame.height, frame.width}, {}, calibration, mission.layout.valves[0]);
    const Vec3 mark = panel.linear() * Vec3(-std::sin(angle_rad), std::cos(angle_rad), 0);
    EXPECT_GT(pointer.direction.dot(mark), 0) << "seed " << seed << ", " << deg_from_rad(angle_rad) << " deg, evidence "
                                              << pointer.still_evidence;
    least = std::min(least, std::abs(pointer.still_evidence));
  }
  EXPECT_GT(least, 0.4) << "seed " << seed;
  RecordProperty("least_evidence", std::to_string(least));
  std::printf("least evidence %.2f\n", least);
}

INSTANTIATE_TEST_SUITE_P(InWater, RenderedPointer,
                         testing::Values(Conditions{0.1, 1, false}, Conditions{0.1, 1, true}, Conditions{0.4, 2, false},
                                         Conditions{0.4, 2, true}, Conditions{0.8, 3, false}, Conditions{0.8, 3, true}));

}  // namespace
}  // namespace lf::vision
