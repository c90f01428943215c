// A stripe on printed marks, as the simulator forms it: what a plain product of the off picture and a bell makes of it. On the model that it inverts, that fit errs
// by hundredths of a pixel; on a picture in nature's order by three tenths.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

struct MarkedPlate {
  MarkedPlate() {
    CameraConfig camera = quiet_camera();
    camera.read_noise_grey = 0.4;
    camera.blur_px = 1.0;
    config.cameras.push_back(camera);
    // A marker of 8 x 8 cells, some 6 px each, facing the camera. Its face is a box's top: the plate is turned toward the camera.
    scene::Shape plate = make_shape(scene::ShapeKind::box, {0.4, 0.4, 0.02}, Vec3::Zero(), 0.8f);
    plate.body_from_shape.linear() =
        (Eigen::AngleAxisd(0.35, Vec3::UnitX()) * Eigen::AngleAxisd(-pi / 2, Vec3::UnitY())).toRotationMatrix();
    plate.body_from_shape.translation() = Vec3(0.71, 0, 0);
    plate.marker_id = 5;
    plate.marker_size_m = 0.075;
    body(config.scene, arm5e_body::panel).shapes.push_back(plate);
    config.water = dark_clear_water();
    config.water.ambient_w_m2 = {9, 9, 9};
  }
  Frame render(double height_m, bool laser) {
    config.lasers.clear();
    const Vec3 from(0, 0, 0.4), toward(0.7, 0, height_m);
    config.lasers.push_back(vehicle_laser(sheet(from, toward - from, Vec3::UnitY())));
    config.lasers[0].waist_sigma_m = 0.0021, config.lasers[0].divergence_rad = 0;  // 1.2 px
    config.lasers[0].power_w = 0.25;
    Optics optics(config);
    Shot shot;
    shot.poses = resting();
    shot.laser = laser ? 1 : 0;
    shot.truth = laser;
    shot.gain = 1;
    Frame frame;
    optics.render(shot, frame);
    return frame;
  }
  OpticsConfig config;
};

// Least squares over centre, height and offset of on - off = off (h bell + o), of the stripe's width in the picture: the model of albedo times a blurred beam.
double plain_product_centre(const std::vector<double>& difference, const std::vector<double>& off, double start, double sigma) {
  double best = start, least = 1e300;
  for (double centre = start - 2.5; centre <= start + 2.5; centre += 0.005) {
    double aa = 0, ab = 0;
    const auto first = static_cast<std::size_t>(start - 6), last = static_cast<std::size_t>(start + 6);
    for (std::size_t v = first; v <= last; ++v) {
      const double x = static_cast<double>(v) - centre, model = off[v] * std::exp(-x * x / (2 * sigma * sigma));
      aa += model * model, ab += model * difference[v];
    }
    const double h = ab / aa;
    double rest = 0;
    for (std::size_t v = first; v <= last; ++v) {
      const double x = static_cast<double>(v) - centre, left = difference[v] - h * off[v] * std::exp(-x * x / (2 * sigma * sigma));
      rest += left * left;
    }
    if (rest < least) least = rest, best = centre;
  }
  return best;
}

TEST(MarksUnderAStripe, APlainProductFitErrsByThreeTenthsOfAPixel) {
  MarkedPlate plate;
  double squares = 0;
  int count = 0;
  for (int step = 0; step < 12; ++step) {
    const double height_m = -0.034 + 0.006 * step;
    const Frame on = plate.render(height_m, true), off = plate.render(height_m, false);
    for (std::int32_t u = 300; u < 340; ++u) {
      const double truth = double(on.stripe_v[static_cast<std::size_t>(u)]);
      if (std::isnan(truth)) continue;
      std::vector<double> difference, background;
      for (std::int32_t v = 0; v < 480; ++v) {
        const auto i = static_cast<std::size_t>(v * 640 + u);
        difference.push_back(double(on.pixels[i]) - double(off.pixels[i])), background.push_back(double(off.pixels[i]));
      }
      const auto row = static_cast<std::size_t>(std::lround(truth));
      // Columns with a step of paint within the stripe.
      double low = 255, high = 0;
      for (std::size_t v = row - 3; v <= row + 3; ++v) low = std::min(low, background[v]), high = std::max(high, background[v]);
      if (high < 5 * low) continue;
      const double error = plain_product_centre(difference, background, truth, std::sqrt(1.2 * 1.2 + 1.0 + 1.0 / 12)) - truth;
      squares += error * error, ++count;
    }
  }
  ASSERT_GT(count, 100);
  const double rms = std::sqrt(squares / count);
  RecordProperty("rms_px", std::to_string(rms));
  EXPECT_GT(rms, 0.2);
  EXPECT_LT(rms, 0.5);
}

}  // namespace
}  // namespace lf::optics::test
