#include "firmware/scan/panel_frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "firmware/scan/camera_model.hpp"
#include "tests/unit/scan/docked_scene.hpp"

namespace lf::scan {
namespace {

const PanelLayout layout;

MarkerCalibrations nominal_markers() {
  const PanelLayout::Marker& marker = layout.markers[0];
  return MarkerCalibrations(MarkerCalibration{marker.id, marker.size_m, marker.panel_from_tag()});
}

double angle_deg(const Vec3& a, const Vec3& b) { return deg_from_rad(std::atan2(a.cross(b).norm(), a.dot(b))); }

// What a perfect panel vision would answer, and its errors on top: `corner_px` rms on the corners, `plane_rad` on the plane's normal.
// `standing`: where the markers really are.
template <class Random>
PanelResult seen(const Pose& base_from_panel, double handle_rad, Random& random, double corner_px, double plane_rad,
                 const MarkerCalibrations& standing = nominal_markers()) {
  std::normal_distribution<double> normal(0, 1);
  const CameraCalibration camera = test::nominal_camera();
  const CameraModel model(camera.intrinsics);
  PanelResult result;
  result.fit.valid = true;
  result.fit.plane.normal = (base_from_panel.linear() * Vec3(plane_rad * normal(random), plane_rad * normal(random), 1)).normalized();
  result.fit.plane.offset_m = -result.fit.plane.normal.dot(base_from_panel.translation());
  for (const MarkerCalibration& marker : standing) {
    MarkerObservation observation;
    observation.id = marker.id;
    observation.camera_from_tag = camera.base_from_camera.inverse() * base_from_panel * marker.panel_from_tag;
    const double h = marker.size_m / 2;
    const Vec3 corners[] = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
    for (std::size_t i = 0; i < 4; ++i)
      observation.corners_px[i] =
          *model.project(observation.camera_from_tag * corners[i]) + corner_px * Vec2(normal(random), normal(random));
    EXPECT_TRUE(result.markers.push_back(observation));
  }

  ProudCluster handle;
  handle.centroid_m = base_from_panel * Vec3(0.001, -0.001, 0.103);
  handle.axis = base_from_panel.linear() * Vec3(-std::sin(handle_rad), std::cos(handle_rad), 0);
  handle.length_m = 0.095;
  handle.width_m = 0.0126;
  handle.height_m = 0.103;
  handle.points = 180;
  EXPECT_TRUE(result.clusters.push_back(handle));
  for (const PanelLayout::Button& button : layout.buttons) {
    ProudCluster cap;
    cap.centroid_m = base_from_panel * Vec3(button.at_m.x() + 0.002, button.at_m.y() - 0.001, 0.030);
    cap.length_m = 0.04;
    cap.width_m = 0.038;
    cap.height_m = 0.030;
    cap.points = 250;
    EXPECT_TRUE(result.clusters.push_back(cap));
  }
  return result;
}

TEST(PanelFrameTest, IsExactWhereNothingErrs) {
  std::mt19937_64 random(30);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 30");
    const Pose truth = test::docked_panel(random, 0.020, rad_from_deg(2));
    const PanelFrame frame = find_panel_frame(seen(truth, 0.3, random, 0, 0), nominal_markers(), test::nominal_camera(), {});
    ASSERT_EQ(frame.outcome, PanelFrameOutcome::ok);
    EXPECT_LT((frame.base_from_panel.matrix() - truth.matrix()).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_NEAR(frame.marker_size_m, layout.markers[0].size_m, 1e-9);
    EXPECT_LT(frame.centre_disagreement_m, 1e-9);
    EXPECT_LT(frame.normal_disagreement_rad, 1e-7);
  }
}

TEST(PanelFrameTest, ValveBaseIsWithinAMillimetreAtCornerErrorsOfATenthPixel) {
  std::mt19937_64 random(31);
  std::vector<double> base_mm, normal_deg;
  for (int trial = 0; trial < 400; ++trial) {
    const Pose truth = test::docked_panel(random, 0.020, rad_from_deg(2));
    const PanelFrame frame =
        find_panel_frame(seen(truth, 0, random, 0.1, rad_from_deg(0.05)), nominal_markers(), test::nominal_camera(), {});
    ASSERT_EQ(frame.outcome, PanelFrameOutcome::ok) << "trial " << trial << " of seed 31";
    base_mm.push_back(1e3 * (frame.base_from_panel.translation() - truth.translation()).norm());
    normal_deg.push_back(angle_deg(frame.base_from_panel.linear().col(2), truth.linear().col(2)));
  }
  std::sort(base_mm.begin(), base_mm.end());
  EXPECT_LT(base_mm[380], 1.6);  // p95
  EXPECT_GT(base_mm[380], 0.3);
}

TEST(PanelFrameTest, SaysWhyThereIsNone) {
  std::mt19937_64 random(32);
  const Pose truth = layout.nominal_base_from_panel();
  const CameraCalibration camera = test::nominal_camera();
  const PanelResult good = seen(truth, 0, random, 0, 0);
  const auto outcome = [&](const PanelResult& result) { return find_panel_frame(result, nominal_markers(), camera, {}).outcome; };
  EXPECT_EQ(outcome(good), PanelFrameOutcome::ok);

  PanelResult bad = good;
  bad.fit.valid = false;
  EXPECT_EQ(outcome(bad), PanelFrameOutcome::no_plane);
  bad = good;
  bad.markers.clear();
  EXPECT_EQ(outcome(bad), PanelFrameOutcome::no_marker);
  bad = good;
  bad.markers[0].id = layout.markers[0].id + 1;
  EXPECT_EQ(outcome(bad), PanelFrameOutcome::no_marker);
  bad = good;
  bad.markers[0].corners_px[2] += Vec2(12, 8);
  EXPECT_EQ(outcome(bad), PanelFrameOutcome::bad_marker);
  bad = good;
  bad.fit.plane.offset_m += 0.04;  // a plane 40 mm off makes the square larger, too
  EXPECT_NE(outcome(bad), PanelFrameOutcome::ok);
  bad = good;
  bad.markers[0].camera_from_tag.translation().z() += 0.05;
  EXPECT_EQ(outcome(bad), PanelFrameOutcome::poses_disagree);
  bad = good;
  bad.markers[0].corners_px[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(outcome(bad), PanelFrameOutcome::not_a_number);
  bad = good;
  bad.fit.plane.normal.x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(outcome(bad), PanelFrameOutcome::not_a_number);
  // A plane through the camera.
  bad = good;
  bad.fit.plane.offset_m = -bad.fit.plane.normal.dot(camera.base_from_camera.translation());
  EXPECT_EQ(outcome(bad), PanelFrameOutcome::no_plane);
}

#ifndef LANTERNFISH_SMALL_CORE  // which holds two

Pose tag_at(double x_m, double y_m, double height_m, double turn_rad) {
  return Pose(Eigen::Translation3d(x_m, y_m, height_m) * Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()));
}

Vec2 place(const MarkerCalibration& marker) { return marker.panel_from_tag.translation().head<2>(); }

// All of it is in the picture of a camera that stands as it should, wherever the docking leaves the panel.
bool in_the_picture(const MarkerCalibration& marker) {
  constexpr double border_px = 30;
  const CameraCalibration camera = test::nominal_camera();
  const CameraModel model(camera.intrinsics);
  const double h = marker.size_m / 2;
  const Vec3 corners[] = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
  return std::all_of(std::begin(corners), std::end(corners), [&](const Vec3& corner) {
    const auto pixel = model.project(camera.base_from_camera.inverse() * layout.nominal_base_from_panel() * marker.panel_from_tag * corner);
    return pixel && pixel->x() > border_px && pixel->y() > border_px && pixel->x() < camera.intrinsics.width - border_px &&
           pixel->y() < camera.intrinsics.height - border_px;
  });
}

// Of several sizes, on plates of several thicknesses, turned, and at least `apart_m` from each other.
template <class Random>
MarkerCalibrations drawn_markers(Random& random, std::size_t count, double apart_m) {
  const auto within = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  MarkerCalibrations markers;
  while (markers.size() < count) {
    MarkerCalibration marker;
    marker.size_m = within(0.05, 0.10);
    const double x_m = within(-0.34, 0.34), y_m = within(-0.32, 0.16), height_m = within(0.001, 0.010);
    marker.panel_from_tag = tag_at(x_m, y_m, height_m, within(-pi, pi));
    if (!in_the_picture(marker)) continue;
    const bool apart =
        std::all_of(markers.begin(), markers.end(), [&](const auto& other) { return (place(marker) - place(other)).norm() >= apart_m; });
    if (!apart) markers.clear();  // there may be no room left
    marker.id = static_cast<std::int32_t>(11 + markers.size());
    (void)markers.push_back(marker);
  }
  return markers;
}

// About the panel's normal.
double turn_of(const Pose& found, const Pose& truth) {
  const Vec3 right = truth.linear().transpose() * found.linear().col(0);
  return std::atan2(right.y(), right.x());
}

void shift(MarkerCalibration& marker, const Vec2& by_m) { marker.panel_from_tag.translation().head<2>() += by_m; }

TEST(SeveralMarkers, TwoOrThreeGiveTheExactFrameWhereNothingErrs) {
  std::mt19937_64 random(36);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 36");
    const std::size_t count = 2 + trial % 2;
    const MarkerCalibrations markers = drawn_markers(random, count, 0.15);
    const Pose truth = test::docked_panel(random, 0.020, rad_from_deg(2));
    const PanelFrame frame = find_panel_frame(seen(truth, 0.3, random, 0, 0, markers), markers, test::nominal_camera(), {});
    ASSERT_EQ(frame.outcome, PanelFrameOutcome::ok);
    EXPECT_EQ(frame.markers, count);
    EXPECT_LT((frame.base_from_panel.matrix() - truth.matrix()).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(SeveralMarkers, TwoHalfAMetreApartTellTheTurnThreeTimesBetterThanEitherAlone) {
  std::mt19937_64 random(37);
  const MarkerCalibrations both({1, 0.080, tag_at(-0.25, 0.05, 0.002, 0)}, MarkerCalibration{2, 0.080, tag_at(0.25, 0.05, 0.002, 0)});
  ASSERT_TRUE(in_the_picture(both[0]) && in_the_picture(both[1]));
  const MarkerCalibrations left(both[0]), right(both[1]);
  constexpr int draws = 200;
  double both_squares = 0, left_squares = 0, right_squares = 0;
  for (int draw = 0; draw < draws; ++draw) {
    const Pose truth = test::docked_panel(random, 0.020, rad_from_deg(2));
    const PanelResult result = seen(truth, 0, random, 0.1, 0, both);
    const auto turn = [&](const MarkerCalibrations& markers) {
      const PanelFrame frame = find_panel_frame(result, markers, test::nominal_camera(), {});
      EXPECT_EQ(frame.outcome, PanelFrameOutcome::ok) << "draw " << draw << " of seed 37";
      EXPECT_EQ(frame.markers, markers.size()) << "draw " << draw << " of seed 37";
      return turn_of(frame.base_from_panel, truth);
    };
    both_squares += std::pow(turn(both), 2);
    left_squares += std::pow(turn(left), 2);
    right_squares += std::pow(turn(right), 2);
  }
  EXPECT_GT(both_squares, 0);
  EXPECT_LT(9 * both_squares, std::min(left_squares, right_squares));
}

TEST(SeveralMarkers, OfThreeTheOneThatStandsElsewhereIsLeftOut) {
  std::mt19937_64 random(38);
  std::uniform_real_distribution<double> any(-pi, pi);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 38");
    const MarkerCalibrations surveyed = drawn_markers(random, 3, 0.25);
    const std::size_t stray = trial % 3;
    MarkerCalibrations standing = surveyed, others;
    const double direction = any(random);
    shift(standing[stray], 0.015 * Vec2(std::cos(direction), std::sin(direction)));
    for (std::size_t i = 0; i < 3; ++i) {
      if (i != stray) (void)others.push_back(surveyed[i]);
    }
    const PanelResult result = seen(test::docked_panel(random, 0.020, rad_from_deg(2)), 0, random, 0, 0, standing);
    const PanelFrame frame = find_panel_frame(result, surveyed, test::nominal_camera(), {});
    const PanelFrame of_others = find_panel_frame(result, others, test::nominal_camera(), {});
    ASSERT_EQ(of_others.outcome, PanelFrameOutcome::ok);
    ASSERT_EQ(frame.outcome, PanelFrameOutcome::ok);
    EXPECT_EQ(frame.markers, 2u);
    EXPECT_NE(frame.marker, stray);
    EXPECT_LT((frame.base_from_panel.matrix() - of_others.base_from_panel.matrix()).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(SeveralMarkers, OfTwoThatDisagreeNoneIsBelieved) {
  std::mt19937_64 random(39);
  for (const double apart_m : {0.2, 0.35, 0.5}) {
    const MarkerCalibrations surveyed({1, 0.080, tag_at(-apart_m / 2, 0.05, 0.002, 0)},
                                      MarkerCalibration{2, 0.080, tag_at(apart_m / 2, 0.05, 0.002, 0)});
    const Pose truth = test::docked_panel(random, 0.020, rad_from_deg(2));
    const auto outcome = [&](std::size_t which, const Vec2& by_m) {
      MarkerCalibrations standing = surveyed;
      shift(standing[which], by_m);
      return find_panel_frame(seen(truth, 0, random, 0, 0, standing), surveyed, test::nominal_camera(), {}).outcome;
    };
    EXPECT_EQ(outcome(0, Vec2(0, 0)), PanelFrameOutcome::ok);
    for (const std::size_t which : {std::size_t{0}, std::size_t{1}}) {
      for (const double by_m : {0.015, -0.015}) {
        EXPECT_EQ(outcome(which, Vec2(by_m, 0)), PanelFrameOutcome::bad_marker) << "along, " << apart_m << " m apart";
        EXPECT_EQ(outcome(which, Vec2(0, by_m)), PanelFrameOutcome::bad_marker) << "across, " << apart_m << " m apart";
      }
    }
  }
}

TEST(SeveralMarkers, OneOfAnUnknownIdAndOneThatIsGivenTwiceChangeNothing) {
  std::mt19937_64 random(40);
  for (int trial = 0; trial < 50; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 40");
    const MarkerCalibrations surveyed = drawn_markers(random, 2, 0.25);
    const Pose truth = test::docked_panel(random, 0.020, rad_from_deg(2));
    const PanelResult good = seen(truth, 0, random, 0.1, 0, surveyed);
    MarkerCalibrations strange = drawn_markers(random, 1, 0);
    strange[0].id = 99;
    PanelResult more = seen(truth, 0, random, 0.1, 0, strange);
    for (const MarkerObservation& marker : good.markers) EXPECT_TRUE(more.markers.push_back(marker));
    EXPECT_TRUE(more.markers.push_back(good.markers[static_cast<std::size_t>(trial % 2)]));
    const PanelFrame expected = find_panel_frame(good, surveyed, test::nominal_camera(), {});
    const PanelFrame frame = find_panel_frame(more, surveyed, test::nominal_camera(), {});
    ASSERT_EQ(expected.outcome, PanelFrameOutcome::ok);
    ASSERT_EQ(frame.outcome, PanelFrameOutcome::ok);
    EXPECT_EQ(frame.markers, 2u);
    EXPECT_EQ(frame.base_from_panel.matrix(), expected.base_from_panel.matrix());
    EXPECT_EQ(more.markers[frame.marker].id, good.markers[expected.marker].id);
  }
}

#endif

TEST(Handle, AngleIsAboutThePanelsNormalFromUpwardCounterClockwise) {
  std::mt19937_64 random(33);
  std::uniform_real_distribution<double> any(-pi / 2, pi / 2);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial << " of seed 33");
    const double angle = any(random);
    PanelResult result = seen(test::docked_panel(random, 0.020, rad_from_deg(2)), angle, random, 0, 0);
    if (trial % 2) result.clusters[0].axis = -result.clusters[0].axis;  // the axis has no sign
    const PanelFrame frame = find_panel_frame(result, nominal_markers(), test::nominal_camera(), {});
    const HandleObservation handle = find_handle(result, frame, layout.valves[0], {});
    ASSERT_TRUE(handle.found);
    EXPECT_NEAR(wrap(handle.angle_rad - angle, pi / 2), 0, 1e-9);
    EXPECT_LT((handle.centre_m - Vec3(0.001, -0.001, 0.103)).norm(), 1e-9);
    EXPECT_GT(handle.sigma_rad, 0);
    EXPECT_LT(handle.sigma_rad, 0.05);
  }
}

TEST(Handle, IsNotWhatIsTooLowTooLongTooFarOrTooFewPoints) {
  std::mt19937_64 random(34);
  const PanelResult good = seen(layout.nominal_base_from_panel(), 0.5, random, 0, 0);
  const PanelFrame frame = find_panel_frame(good, nominal_markers(), test::nominal_camera(), {});
  const auto found = [&](auto change) {
    PanelResult result = good;
    change(result.clusters[0]);
    return find_handle(result, frame, layout.valves[0], {}).found;
  };
  EXPECT_TRUE(found([](ProudCluster&) {}));
  EXPECT_FALSE(found([](ProudCluster& c) { c.height_m = 0.03; }));
  EXPECT_FALSE(found([](ProudCluster& c) { c.length_m = 0.3; }));
  EXPECT_FALSE(found([](ProudCluster& c) { c.length_m = 0.02; }));
  EXPECT_FALSE(found([](ProudCluster& c) { c.centroid_m += Vec3(0, 0.05, 0); }));
  EXPECT_FALSE(found([](ProudCluster& c) { c.points = 3; }));
  EXPECT_FALSE(found([](ProudCluster& c) { c.axis.x() = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_FALSE(find_handle(good, PanelFrame{}, layout.valves[0], {}).found);
}

TEST(Buttons, AreFoundNearTheirPlacesAndNowhereElse) {
  std::mt19937_64 random(35);
  PanelResult result = seen(test::docked_panel(random, 0.020, rad_from_deg(2)), 0, random, 0, 0);
  const PanelFrame frame = find_panel_frame(result, nominal_markers(), test::nominal_camera(), {});
  for (const PanelLayout::Button& button : layout.buttons) {
    const ButtonObservation observation = find_button(result, frame, button);
    ASSERT_TRUE(observation.found);
    EXPECT_LT((observation.centre_m - Vec3(button.at_m.x() + 0.002, button.at_m.y() - 0.001, 0.030)).norm(), 1e-9);
  }
  result.clusters[2].centroid_m += Vec3(0, 0, 0.05);  // the centre cap's points are somewhere else
  EXPECT_FALSE(find_button(result, frame, layout.buttons[1]).found);
  EXPECT_TRUE(find_button(result, frame, layout.buttons[2]).found);
}

}  // namespace
}  // namespace lf::scan
