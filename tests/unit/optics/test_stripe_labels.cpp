// What a rendered frame says of its stripe, against the picture itself and against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <set>
#include <vector>

#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {
namespace {

constexpr double distance_m = 0.7;

// A plate that faces the camera and ends at z = `end_m`, above the image's middle being negative; a sheet from above and before it.
struct Labelled {
  Labelled(double end_m, const Vec3& toward) {
    config.cameras.push_back(quiet_camera());
    body(config.scene, arm5e_body::panel)
        .shapes.push_back(make_shape(scene::ShapeKind::box, {0.02, 2, 2}, {distance_m + 0.01, 0, end_m - 1}, 0.5f));
    config.water = dark_clear_water();
    laser = sheet(from, toward - from, Vec3::UnitY());
    config.lasers.push_back(vehicle_laser(laser));
  }
  Frame render(bool laser_on) {
    Optics optics(config);
    Shot shot;
    shot.poses = resting();
    shot.laser = laser_on ? 1.f : 0.f;
    shot.truth = laser_on;
    Frame frame;
    optics.render(shot, frame);
    return frame;
  }
  // Standard deviation of the light on the plate along z in column u, m.
  double sigma_m(double u) const {
    const CameraIntrinsics k;
    const Vec3 at(distance_m, distance_m * (u - k.cx) / k.fx, centre_m());
    const LaserConfig& sheet = config.lasers[0];
    return std::hypot(sheet.waist_sigma_m, sheet.divergence_rad * (at - from).norm()) / std::abs(laser.linear().col(0).z());
  }
  // Where the sheet's middle meets the plate's plane: the same in all columns.
  double centre_m() const {
    const Vec3 n = laser.linear().col(0);
    return from.z() - n.x() * (distance_m - from.x()) / n.z();
  }

  OpticsConfig config;
  const Vec3 from{0.05, 0, -0.35};
  Pose laser;
};

double difference(const Frame& on, const Frame& off, int u, int v) {
  const auto at = static_cast<std::size_t>(v * on.width + u);
  return double(on.pixels[at]) - double(off.pixels[at]);
}

// sigma: of the light on the plate, seen by the camera; the lens's spot and the pixel's aperture on top. height: of the bell that has the picture's light.
TEST(StripeLabels, WidthAndHeightOfAPieceAreThoseOfThePicture) {
  for (const double blur_px : {0.6, 1.0, 1.4}) {
    Labelled s(1.0, Vec3(distance_m, 0, 0.05));
    s.config.cameras[0].blur_px = blur_px;
    s.config.lasers[0].power_w = 0.25;
    const Frame on = s.render(true), off = s.render(false);
    const CameraIntrinsics k;
    int seen = 0;
    double ratios = 0;
    for (const StripePiece& piece : on.pieces) {
      if (piece.u < 200 || piece.u > 440) continue;
      ASSERT_FALSE(piece.part) << piece.u;
      ++seen;
      const double centre = k.cy + k.fy * s.centre_m() / distance_m;
      EXPECT_NEAR(piece.v, centre, 0.01) << piece.u;
      const double beam = k.fy * s.sigma_m(piece.u) / distance_m, sigma = std::sqrt(beam * beam + blur_px * blur_px + 1.0 / 12);
      EXPECT_NEAR(piece.sigma_px, sigma, 0.02 * sigma) << piece.u;
      double light = 0, highest = 0;
      for (int v = static_cast<int>(centre) - 14; v <= static_cast<int>(centre) + 15; ++v) {
        light += difference(on, off, piece.u, v);
        highest = std::max(highest, difference(on, off, piece.u, v));
      }
      ASSERT_LT(highest, 250) << "not clipped";
      ASSERT_GT(highest, 60);
      // The paint is grained: the label has it at the centre, the picture over the stripe's rows.
      const double height = light / (std::sqrt(2 * pi) * sigma);
      EXPECT_NEAR(piece.grey, height, 0.05 * height) << piece.u << ", blur " << blur_px;
      ratios += double(piece.grey) / height;
    }
    ASSERT_GE(seen, 240);
    EXPECT_NEAR(ratios / seen, 1, 0.01) << "blur " << blur_px;
  }
}

// Spots of lenses grow with the square of the distance from the picture's middle. Independently: the closed form, and the light of the picture.
TEST(StripeLabels, WidthAndHeightCountTheWiderSpotOfTheCorners) {
  constexpr double middle_px = 0.9, corner_px = 1.8;
  Labelled s(1.0, Vec3(distance_m, 0, 0.25));
  s.config.cameras[0].blur_px = middle_px;
  s.config.cameras[0].corner_blur = corner_px / middle_px;
  s.config.lasers[0].power_w = 0.25;
  const Frame on = s.render(true), off = s.render(false);
  const CameraIntrinsics k;
  int outside = 0;
  double ratios = 0;
  for (const StripePiece& piece : on.pieces) {
    const double out_u = (piece.u - 319.5) / 319.5, out_v = (double(piece.v) - 239.5) / 319.5;
    const double to_corner2 = (out_u * out_u + out_v * out_v) / (1 + 0.75 * 0.75);
    if (piece.part || piece.u < 16 || piece.u > 623 || to_corner2 < 0.4) continue;
    const double beam = k.fy * s.sigma_m(piece.u) / distance_m;
    const double spot2 = middle_px * middle_px + (corner_px * corner_px - middle_px * middle_px) * to_corner2;
    const double sigma = std::sqrt(beam * beam + spot2 + 1.0 / 12);
    EXPECT_NEAR(piece.sigma_px, sigma, 0.02 * sigma) << piece.u;
    double light = 0;
    const int centre = static_cast<int>(std::lround(piece.v));
    for (int v = std::max(centre - 16, 0); v <= std::min(centre + 16, on.height - 1); ++v) light += difference(on, off, piece.u, v);
    ratios += double(piece.grey) / (light / (std::sqrt(2 * pi) * sigma));
    ++outside;
  }
  ASSERT_GE(outside, 100);
  EXPECT_NEAR(ratios / outside, 1, 0.015);
}

// The sheet's middle passes the plate's end: its flank lights the last rows. Independently: a bell that a step cuts off, spread by the lens and summed by the pixel.
TEST(StripeLabels, AFlankAtAPlatesEndIsAPartWhereThePictureIsBrightest) {
  const Labelled whole(1.0, Vec3(distance_m, 0, 0.05));
  const CameraIntrinsics k;
  const double middle_px = k.cy + k.fy * whole.centre_m() / distance_m, blur = whole.config.cameras[0].blur_px;
  for (const double end_px : {263.25, 263.5, 263.75, 262.5}) {
    SCOPED_TRACE(end_px);
    Labelled s((end_px - k.cy) * distance_m / k.fy, Vec3(distance_m, 0, 0.05));
    s.config.lasers[0].power_w = 0.3;
    const Frame on = s.render(true), off = s.render(false);
    std::vector<const StripePiece*> of_column(640, nullptr);
    for (const StripePiece& piece : on.pieces) {
      EXPECT_TRUE(piece.part) << "the sheet's middle meets nothing, column " << piece.u;
      EXPECT_EQ(of_column[static_cast<std::size_t>(piece.u)], nullptr) << "one place of a column is brightest, column " << piece.u;
      EXPECT_EQ(piece.sigma_px, 0);
      of_column[static_cast<std::size_t>(piece.u)] = &piece;
    }
    for (int u = 260; u < 380; u += 20) {
      const double beam = k.fy * whole.sigma_m(u) / distance_m;
      constexpr int first = 250, rows = 24;
      std::vector<double> shape(rows);
      for (int i = 0; i < rows; ++i) {
        constexpr double step = 0.02;
        for (double x = end_px - 20 + step / 2; x < end_px; x += step) {
          const double before = first + i - 0.5 - x, after = before + 1;
          shape[static_cast<std::size_t>(i)] += step * std::exp(-0.5 * std::pow((x - middle_px) / beam, 2)) * 0.5 *
                                                (std::erf(after / blur / std::sqrt(2.0)) - std::erf(before / blur / std::sqrt(2.0)));
        }
      }
      double shapes = 0, light = 0;
      for (int i = 0; i < rows; ++i) shapes += shape[static_cast<std::size_t>(i)], light += difference(on, off, u, first + i);
      ASSERT_GT(light, 10);
      // Each row of two rounded pictures within 1; of an edge's pixel the four rows of samples say its share to an eighth.
      const auto brightest = std::max_element(shape.begin(), shape.end());
      for (int i = 0; i < rows; ++i)
        EXPECT_NEAR(difference(on, off, u, first + i), light * shape[static_cast<std::size_t>(i)] / shapes,
                    1 + light * *brightest / shapes / 8)
            << "row " << first + i;
      ASSERT_NE(of_column[static_cast<std::size_t>(u)], nullptr) << u;
      EXPECT_NEAR(of_column[static_cast<std::size_t>(u)]->v, static_cast<double>(first + std::distance(shape.begin(), brightest)), 1) << u;
    }
  }
}

// The sheet grazes the underside of a box by two degrees, where its stripe is tens of pixels wide. Past the box's end its flank falls on the plate behind, within the
// reach of that width.
TEST(StripeLabels, AFlankBesideAStripeOnAGrazedFaceIsAPart) {
  Labelled s(1.0, Vec3(distance_m, 0, 0.05));
  const Vec3 toward = (Vec3(distance_m, 0, 0.05) - s.from).normalized(), middle = s.from + 0.664 * toward;
  const double slope = std::atan2(toward.z(), toward.x()) + 2 * pi / 180;
  const Vec3 along(std::cos(slope), 0, std::sin(slope)), outward(-std::sin(slope), 0, std::cos(slope)), end = middle + 0.03 * along;
  scene::Shape box = make_shape(scene::ShapeKind::box, {0.24, 2, 0.04}, end - 0.12 * along - 0.02 * outward, 0.5f);
  box.body_from_shape.linear().col(0) = along;
  box.body_from_shape.linear().col(1) = Vec3::UnitY();
  box.body_from_shape.linear().col(2) = outward;
  body(s.config.scene, arm5e_body::panel).shapes.push_back(box);
  s.config.lasers[0].power_w = 0.3;
  const CameraIntrinsics k;
  const double on_box_px = k.cy + k.fy * middle.z() / middle.x();
  const double on_plate_px = k.cy + k.fy * (s.from.z() + (end - s.from).z() * (distance_m - s.from.x()) / (end - s.from).x()) / distance_m;
  std::set<std::int32_t> wide, parts;  // columns
  for (const StripePiece& piece : s.render(true).pieces) {
    if (std::abs(piece.u - 320) > 60) continue;
    if (piece.part) {
      EXPECT_NEAR(piece.v, on_plate_px, 1.5) << piece.u;
      parts.insert(piece.u);
    } else {
      EXPECT_NEAR(piece.v, on_box_px, 0.5) << piece.u;
      EXPECT_GT(4.5 * piece.sigma_px, on_plate_px - on_box_px) << "or it is out of reach anyway";
      wide.insert(piece.u);
    }
  }
  EXPECT_EQ(wide.size(), 121u);
  EXPECT_EQ(parts.size(), 121u);
}

// Too faint a flank is none: three grey levels are asked for.
TEST(StripeLabels, FarBeyondThePlateThereIsNoPiece) {
  const Labelled whole(1.0, Vec3(distance_m, 0, 0.05));
  Labelled s(whole.centre_m() - 6 * whole.sigma_m(320), Vec3(distance_m, 0, 0.05));
  for (const StripePiece& piece : s.render(true).pieces) EXPECT_NE(piece.u, 320);
}

// Darker paint, flush with the plate, from 0.30 m to the right of the middle on and in a patch just under the stripe: both where the reference has them.
TEST(StripeLabels, APieceWithOtherPaintInReachIsNearAMark) {
  Labelled s(1.0, Vec3(distance_m, 0, 0.05));
  constexpr double thin_m = 1e-4, right_m = 0.30;
  const double row_m = distance_m / CameraIntrinsics().fy;
  auto& shapes = body(s.config.scene, arm5e_body::panel).shapes;
  const auto paint = [&](double y_m, double z_m, double width_m, double height_m, float albedo) {
    shapes.push_back(make_shape(scene::ShapeKind::box, {thin_m, width_m, height_m}, {distance_m, y_m, z_m}, albedo));
  };
  paint(right_m + 0.5, 0, 1, 2, 0.1f);
  paint(0, s.centre_m() + 3.5 * row_m + 0.05, 0.1, 0.1, 0.1f);      // its edge three to four rows below
  paint(-0.2, s.centre_m() + 8.5 * row_m + 0.05, 0.1, 0.1, 0.1f);   // eight to nine: beyond the stripe's reach
  paint(-0.4, s.centre_m() + 3.5 * row_m + 0.05, 0.1, 0.1, 0.45f);  // a shade, within the grain's differences
  const Frame on = s.render(true);
  const CameraIntrinsics k;
  const auto column = [&](double y_m) { return k.cx + k.fx * y_m / distance_m; };
  int marked = 0, plain = 0;
  for (const StripePiece& piece : on.pieces) {
    if (piece.part || piece.u < 20 || piece.u > 620) continue;
    const double edge = column(right_m), to_edge = std::abs(piece.u - edge), patch = column(0.05), other = column(-0.05);
    const bool on_patch = piece.u > other + 1 && piece.u < patch - 1, off_patch = piece.u < other - 3 || piece.u > patch + 3;
    if (to_edge < 1.4 || on_patch) {
      ++marked;
      EXPECT_TRUE(piece.near_mark) << piece.u;
    } else if (to_edge > 3.5 && off_patch) {
      ++plain;
      EXPECT_FALSE(piece.near_mark) << piece.u;
    }
  }
  EXPECT_GT(marked, 45);
  EXPECT_GT(plain, 400);
}

// A post in the sheet keeps the direct light off some columns of the plate. In hazy water what the laser's way has scattered still falls there: a peak on it is not false.
TEST(StripeLabels, WhereSomethingIsInTheSheetOnlyScatteredLightHasAPart) {
  for (const double attenuation : {0.0, 0.8}) {
    Labelled s(1.0, Vec3(distance_m, 0, 0.05));
    s.config.water.attenuation_per_m = attenuation;
    const Vec3 way = Vec3(distance_m, 0, s.centre_m()) - s.from;
    body(s.config.scene, arm5e_body::forearm)
        .shapes.push_back(make_shape(scene::ShapeKind::box, {0.01, 0.03, 0.01}, s.from + 0.85 * way, 0.0f));
    const Frame on = s.render(true), off = s.render(false);
    const CameraIntrinsics k;
    const double row = k.cy + k.fy * s.centre_m() / distance_m;
    int shaded = 0, lit = 0;
    double light = 0;
    for (const StripePiece& piece : on.pieces) {
      if (std::abs(double(piece.v) - row) > 0.5) continue;  // the post's own top
      const double y_m = (piece.u - k.cx) / k.fx * distance_m, edge_m = 0.015 / 0.85;
      if (std::abs(y_m) < edge_m - 0.004) {
        ++shaded;
        EXPECT_TRUE(piece.part) << piece.u;
        light += difference(on, off, piece.u, static_cast<int>(std::lround(piece.v)));
      } else if (std::abs(y_m) > edge_m + 0.004 && std::abs(y_m) < 0.2) {
        ++lit;
        EXPECT_FALSE(piece.part) << piece.u;
      }
    }
    EXPECT_GT(lit, 100);
    if (attenuation > 0) {
      EXPECT_GT(shaded, 8);
      EXPECT_GT(light / shaded, 1);
    } else {
      EXPECT_EQ(shaded, 0);
    }
  }
}

}  // namespace
}  // namespace lf::optics::test
