// Where a stripe's image is through a distorting lens and a flat port, against a camera of the test's own: forward, from the place to its pixel, where the
// renderer follows rays from the pixel to the place.
#include <gtest/gtest.h>

#include <functional>

#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

double bisect(double low, double high, const std::function<double(double)>& rising) {
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (rising(middle) < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Tangent of the angle in air under which a place r off the axis and z before the centre is seen through a flat window. By Snell's law the ray's height gained in
// air, glass and water is one rising function of the sine in air.
double tangent_in_air(const FlatPort& port, double r, double z) {
  const auto tangent = [](double sine) { return sine / std::sqrt(1 - sine * sine); };
  const double sine = bisect(0, 1 - 1e-12, [&](double s) {
    return port.distance_m * tangent(s) + port.thickness_m * tangent(s / port.glass_index) +
           (z - port.distance_m - port.thickness_m) * tangent(s / port.water_index) - r;
  });
  return tangent(sine);
}

// Brown and Conrady's model, as OpenCV states it.
Vec2 image_of(const CameraConfig& camera, const Vec3& place) {
  const Vec3 p = camera.base_from_camera.inverse() * place;
  Vec2 n = p.head<2>() / p.z();
  if (camera.port) {
    const double r = p.head<2>().norm();
    n = r > 0 ? Vec2(p.head<2>() / r * tangent_in_air(*camera.port, r, p.z())) : Vec2(Vec2::Zero());
  }
  const CameraIntrinsics& k = camera.intrinsics;
  const auto& d = k.distortion;
  const double x = n.x(), y = n.y(), r2 = x * x + y * y, radial = 1 + d[0] * r2 + d[1] * r2 * r2 + d[4] * r2 * r2 * r2;
  return {k.cx + k.fx * (x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x)),
          k.cy + k.fy * (y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y)};
}

// The place on the plate x = distance at this y that lies `off_m` from the sheet, or from the cone of this angle about the laser's x axis.
Vec3 on_plate(const Pose& base_from_laser, double cone_rad, double distance_m, double y, double off_m) {
  const Pose laser_from_base = base_from_laser.inverse();
  const auto off = [&](double z) {
    const Vec3 p = laser_from_base * Vec3(distance_m, y, z);
    return (p.x() - std::tan(cone_rad) * std::hypot(p.y(), p.z())) * std::cos(cone_rad) - off_m;
  };
  const bool rising = off(1) > off(-1);
  return {distance_m, y, bisect(-1, 1, [&](double z) { return rising ? off(z) : -off(z); })};
}

struct Case {
  const char* name;
  std::array<double, 5> distortion;
  bool port;
  double cone_rad;
};

const std::vector<Case> cases{{"pinhole", {0, 0, 0, 0, 0}, false, 0},
                              {"barrel", {-0.20, 0.05, 0, 0, 0}, false, 0},
                              {"all terms", {-0.15, 0.03, 0.002, -0.003, 0.01}, false, 0},
                              {"port", {0, 0, 0, 0, 0}, true, 0},
                              {"port and lens", {-0.10, 0.02, 0.001, 0.001, 0}, true, 0},
                              {"cone", {0, 0, 0, 0, 0}, false, 0.02},
                              {"cone, port and lens", {-0.10, 0.02, 0.001, 0.001, 0}, true, -0.02}};

struct StripeCase {
  explicit StripeCase(const Case& c) : cone_rad(c.cone_rad) {
    camera = quiet_camera();
    camera.intrinsics.distortion = c.distortion;
    if (c.port) camera.port = FlatPort{};
    base_from_laser = sheet({0.02, 0.03, 0.38}, Vec3(0.7, 0, -0.33), Vec3(0, 1, 0.1));
    laser = vehicle_laser(base_from_laser);
    laser.cone_rad = c.cone_rad;
    laser.waist_sigma_m = 0.0015, laser.divergence_rad = 0;
  }
  // Row at which column u shows the places that far off the sheet.
  double row(double u, double off_m) const {
    const auto image = [&](double y) { return image_of(camera, on_plate(base_from_laser, cone_rad, distance_m, y, off_m)); };
    return image(bisect(-1.5, 1.5, [&](double y) { return image(y).x() - u; })).y();
  }
  double cone_rad, distance_m = 0.7;
  CameraConfig camera;
  Pose base_from_laser;
  LaserConfig laser;
};

TEST(StripeThroughLens, TrueCentresAreWhereTheTestsOwnCameraSeesTheLine) {
  for (const Case& c : cases) {
    const StripeCase s(c);
    OpticsConfig config;
    config.cameras.push_back(s.camera);
    config.lasers.push_back(s.laser);
    config.scene = plate_scene(s.distance_m);
    config.water = dark_clear_water();
    Optics optics(config);
    Shot shot;
    shot.poses = resting();
    shot.truth = true;
    Frame frame;
    optics.render(shot, frame);
    for (const std::size_t u : {40u, 130u, 215u, 320u, 401u, 500u, 590u})
      // The renderer takes a centre as settled within 2e-3 px.
      EXPECT_NEAR(frame.stripe_v[u], s.row(double(u), 0), 2.5e-3) << c.name << ", column " << u;
  }
}

// The picture's own light: its centre of mass down a column. An even cross-section is not even in a picture that bends it: what that moves the centre of mass by is
// computed from the rows of both flanks. The renderer has the line's
// width of each pixel's own slope: a bell whose width changes along it moves by its fourth moment, three times as much.
TEST(StripeThroughLens, PicturesCentreOfMassIsThere) {
  for (const Case& c : cases) {
    const StripeCase s(c);
    Bench bench(plate_scene(s.distance_m), dark_clear_water());
    bench.add(s.laser);
    const CameraRays rays(s.camera.intrinsics, s.camera.port);
    for (const int u : {40, 130, 215, 320, 401, 500, 590}) {
      const double expected = s.row(u, 0);
      const double bend = std::abs(0.5 * (s.row(u, 0.0015) + s.row(u, -0.0015)) - expected);
      double sum = 0, moment = 0;
      const int about = static_cast<int>(std::lround(expected));
      for (int v = about - 14; v <= about + 14; ++v) {
        const double light = bench.green(s.camera, rays, u, v);
        sum += light, moment += light * v;
      }
      ASSERT_GT(sum, 0) << c.name << ", column " << u;
      // 5e-4 px is what a pinhole's pixels come to (Stripe.CentroidOnAFlatSurface).
      EXPECT_NEAR(moment / sum, expected, 3 * bend + 5e-4) << c.name << ", column " << u;
    }
  }
}

}  // namespace
}  // namespace lf::optics::test
