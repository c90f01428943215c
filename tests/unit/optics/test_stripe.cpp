#include <gtest/gtest.h>

#include <random>

#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

// Where column u meets the image of the line in which the sheet cuts the plane: closed form for a pinhole.
double projected_v(const CameraConfig& camera, const Pose& base_from_laser, const Vec3& plane_normal, const Vec3& on_plane, double u) {
  const CameraIntrinsics& k = camera.intrinsics;
  const Vec3 sheet_normal = base_from_laser.linear().col(0);
  const Vec3 eye = camera.base_from_camera.translation();
  // The plane through the eye and the line, from the pencil of both planes.
  const double a = sheet_normal.dot(eye - base_from_laser.translation()), b = plane_normal.dot(eye - on_plane);
  const Vec3 n = camera.base_from_camera.linear().transpose() * (a * plane_normal - b * sheet_normal);
  return k.cy - k.fy * (n.x() * (u - k.cx) / k.fx + n.z()) / n.y();
}

double centroid_v(const Bench& bench, const CameraConfig& camera, const CameraRays& rays, int u, double about_v) {
  double sum = 0, moment = 0;
  const int middle = static_cast<int>(std::lround(about_v));
  for (int v = middle - 14; v <= middle + 14; ++v) {
    const double light = bench.green(camera, rays, u, v);
    sum += light, moment += light * v;
  }
  return sum > 0 ? moment / sum : -1e9;
}

TEST(Stripe, CentroidOnAFlatSurfaceIsTheProjectedLineWithin1e4OfAPixel) {
  const unsigned seed = 5;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  CameraConfig camera = quiet_camera();
  const CameraRays rays(camera.intrinsics, camera.port);
  WaterConfig water = dark_clear_water();
  water.attenuation_per_m = 0.3;
  water.scattering_share = 0;  // no skirt, and no haze of the sheet on the side that the camera sees through it
  double squares = 0, worst = 0;
  int count = 0;
  for (int trial = 0; trial < 12; ++trial) {
    scene::BodyPoses poses = resting();
    Pose& panel = poses[arm5e_body::panel];
    panel.linear() =
        (Eigen::AngleAxisd(0.4 * unit(random), Vec3::UnitZ()) * Eigen::AngleAxisd(0.4 * unit(random), Vec3::UnitY())).toRotationMatrix();
    const Vec3 toward(0.7, 0.05 * unit(random), 0.1 * unit(random)), from(0.05, 0, 0.40);
    const Pose base_from_laser = sheet(from, toward - from, Vec3(0, 1, 0.2 * unit(random)));
    Bench bench(plate_scene(0.7), water, poses);
    bench.add(vehicle_laser(base_from_laser));
    const Vec3 normal = panel.linear().col(0), on_plane = panel * Vec3(0.7, 0, 0);
    for (int u = 240; u < 400; u += 20) {
      const double expected = projected_v(camera, base_from_laser, normal, on_plane, u);
      const double error = centroid_v(bench, camera, rays, u, expected) - expected;
      squares += error * error, ++count;
      worst = std::max(worst, std::abs(error));
    }
  }
  RecordProperty("rms_px", std::to_string(std::sqrt(squares / count)));
  EXPECT_LT(std::sqrt(squares / count), 1e-4);
  EXPECT_LT(worst, 5e-4);
}

struct StripeScene {
  StripeScene() {
    config.cameras.push_back(quiet_camera());
    config.scene = plate_scene(0.7);
    config.water = dark_clear_water();
    // A post before the plate: the stripe climbs it and its shadow cuts the stripe.
    config.scene[arm5e_body::first_feature].shapes.push_back(make_shape(scene::ShapeKind::box, {0.04, 0.04, 0.6}, {0.58, 0.0, 0.0}));
    base_from_laser = sheet({0.0, 0.0, 0.40}, Vec3(0.7, 0, -0.35), Vec3::UnitY());
    config.lasers.push_back(vehicle_laser(base_from_laser));
  }
  Frame render(bool laser, bool truth) {
    Optics optics(config);
    Shot shot;
    shot.poses = resting();
    shot.laser = laser;
    shot.truth = truth;
    Frame frame;
    optics.render(shot, frame);
    return frame;
  }
  OpticsConfig config;
  Pose base_from_laser;
};

TEST(Stripe, TrueCentresLieOnTheProjectedLinesOfPlateAndPost) {
  StripeScene s;
  const Frame frame = s.render(true, true);
  int on_plate = 0, on_post = 0;
  for (int u = 0; u < 640; ++u) {
    const float v = frame.stripe_v[static_cast<std::size_t>(u)];
    if (std::isnan(v)) continue;
    const double plate = projected_v(s.config.cameras[0], s.base_from_laser, Vec3::UnitX(), {0.7, 0, 0}, u);
    const double post = projected_v(s.config.cameras[0], s.base_from_laser, Vec3::UnitX(), {0.56, 0, 0}, u);
    const bool near_post = std::abs(v - post) < std::abs(v - plate);
    (near_post ? on_post : on_plate)++;
    EXPECT_NEAR(v, near_post ? post : plate, 2e-3) << u;
  }
  EXPECT_GT(on_plate, 400);
  EXPECT_NEAR(on_post, 361.7 * 0.04 / 0.56, 2);  // the post's width in the image
}

TEST(Stripe, ShadowEndsWhereTheEmittersRaysGrazeThePost) {
  StripeScene s;
  s.base_from_laser = sheet({0.0, 0.2, 0.40}, Vec3(0.7, -0.2, -0.35), Vec3::UnitY());  // from the right, so that shadow and post lie apart
  s.config.lasers[0] = vehicle_laser(s.base_from_laser);
  const Frame frame = s.render(true, true);
  // The shadow's left end: the ray that grazes the post's far right... edge (x 0.60, y -0.02) meets the plate x = 0.7 here.
  const double left_y = 0.2 + (-0.02 - 0.2) * 0.7 / 0.56,
               right_y = std::max(0.2 + (0.02 - 0.2) * 0.7 / 0.60, 0.2 + (0.02 - 0.2) * 0.7 / 0.56);
  const CameraIntrinsics k;
  const double left_u = k.cx + k.fx * left_y / 0.7, right_u = k.cx + k.fx * std::min(right_y, -0.02 * 0.7 / 0.56) / 0.7;
  for (int u = 0; u < 640; ++u) {
    const float v = frame.stripe_v[static_cast<std::size_t>(u)];
    const double plate = projected_v(s.config.cameras[0], s.base_from_laser, Vec3::UnitX(), {0.7, 0, 0}, u);
    const bool lit_plate = !std::isnan(v) && std::abs(v - plate) < 0.1;
    if (u > left_u + 1 && u < right_u - 1) {
      EXPECT_FALSE(lit_plate) << u;
    }
    if (u < left_u - 1 && u > left_u - 60) {
      EXPECT_TRUE(lit_plate) << u;
    }
  }
}

TEST(Stripe, EdgeSamplesGiveAShadowsEndItsShareOfThePixel) {
  StripeScene s;
  s.base_from_laser = sheet({0.0, 0.2, 0.40}, Vec3(0.7, -0.2, -0.35), Vec3::UnitY());
  s.config.lasers[0] = vehicle_laser(s.base_from_laser);
  s.config.lasers[0].power_w = 0.3;
  const Frame frame = s.render(true, false);
  const CameraIntrinsics k;
  // The end of the shadow is a vertical edge of the plate's stripe: summed along the row it must sit where geometry puts it, to 1/4 of a sub-pixel.
  const double end_u = k.cx + k.fx * (0.2 + (-0.02 - 0.2) * 0.7 / 0.56) / 0.7;
  const int v = static_cast<int>(std::lround(projected_v(s.config.cameras[0], s.base_from_laser, Vec3::UnitX(), {0.7, 0, 0}, end_u)));
  const int first = static_cast<int>(end_u) - 6;
  const double lit = frame.pixels[static_cast<std::size_t>(v * 640 + first - 4)];
  double pixels = 0;
  for (int u = first; u < first + 12; ++u) pixels += frame.pixels[static_cast<std::size_t>(v * 640 + u)] / lit;
  EXPECT_NEAR(first - 0.5 + pixels, end_u, 0.25);
}

TEST(Stripe, SwitchingTheLaserChangesOnlyPixelsNearIt) {
  StripeScene s;
  s.config.water = WaterConfig{};
  s.config.water.scattering_share = 0;
  const Frame on = s.render(true, true), off = s.render(false, false);
  int changed = 0;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const int difference = on.pixels[static_cast<std::size_t>(v * 640 + u)] - off.pixels[static_cast<std::size_t>(v * 640 + u)];
      const double plate = projected_v(s.config.cameras[0], s.base_from_laser, Vec3::UnitX(), {0.7, 0, 0}, u);
      const double post = projected_v(s.config.cameras[0], s.base_from_laser, Vec3::UnitX(), {0.56, 0, 0}, u);
      const bool near = std::min({std::abs(v - plate), std::abs(v - post)}) < 14;
      if (!near && std::abs(u - 319.5) > 14) {
        EXPECT_LE(std::abs(difference), 1) << u << " " << v;
      }
      changed += difference > 20;
    }
  }
  EXPECT_GT(changed, 1500);
  EXPECT_EQ(off.stripe_v.size(), 0U);
}

TEST(Stripe, ConeBendsTheStripeByItsAngle) {
  StripeScene s;
  s.config.scene = plate_scene(0.7);
  const Frame plane = s.render(true, true);
  s.config.lasers[0].cone_rad = 0.01;
  const Frame cone = s.render(true, true);
  // In the middle the cone's mantle is the plane turned by cone_rad about the emitter, toward +x of the laser.
  const Vec3 z = s.base_from_laser.linear().col(2), x = s.base_from_laser.linear().col(0);
  const auto middle_v = [&](const Vec3& ray) {
    const Vec3 hit = s.base_from_laser.translation() + ray * ((0.7 - s.base_from_laser.translation().x()) / ray.x());
    return CameraIntrinsics{}.cy + CameraIntrinsics{}.fy * hit.z() / hit.x();
  };
  EXPECT_NEAR(plane.stripe_v[320], middle_v(z), 0.01);
  EXPECT_NEAR(cone.stripe_v[320], middle_v(z + x * std::tan(0.01)), 0.01);
}

TEST(Stripe, PatternOfHalfLitPixelsGivesTheShareOfItsFootprint) {
  OpticsConfig config;
  config.cameras.push_back(quiet_camera());
  config.scene = plate_scene(0.7);
  config.water = dark_clear_water();
  LaserConfig projector = vehicle_laser(looking(Vec3::Zero(), Vec3::UnitX()));
  Pattern pattern;
  pattern.width = 64, pattern.height = 48;
  pattern.fx = pattern.fy = 40, pattern.cx = 31.5, pattern.cy = 23.5;
  pattern.lit.assign(64 * 48, 0);
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 32; ++u) pattern.lit[static_cast<std::size_t>(v * 64 + u)] = 1;
  }
  projector.pattern = pattern;
  projector.power_w = 20;
  config.lasers.push_back(projector);
  Optics optics(config);
  Shot shot;
  shot.poses = resting();
  Frame frame;
  optics.render(shot, frame);
  // Projector and camera share a centre: lit left of the image's middle between columns 319 and 320, dark on its right.
  EXPECT_GT(frame.pixels[240 * 640 + 300], 20);
  EXPECT_EQ(frame.pixels[240 * 640 + 340], 0);
  EXPECT_GT(frame.pixels[240 * 640 + 318], 20);
  EXPECT_LE(frame.pixels[240 * 640 + 324], 1);  // four of the lens's standard deviations on
}

}  // namespace
}  // namespace lf::optics::test
