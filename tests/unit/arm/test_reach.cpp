#include <gtest/gtest.h>

#include <cmath>

#include "firmware/arm/reach.hpp"
#include "shared/panel/panel_layout.hpp"
#include "tests/arm5e.hpp"

namespace lf::arm {
namespace {

TEST(Reach, ReproducesTheLayoutsTilts) {
  const PanelLayout layout;
  const Pose base_from_panel = layout.nominal_base_from_panel();
  const auto tilt_deg = [&](const Vec3& panel_point_m) {
    const Reach r = reach(test::arm5e, base_from_panel, panel_point_m, 0.008);
    EXPECT_EQ(r.outcome, IkOutcome::ok) << name(r.outcome);
    return deg_from_rad(r.tilt_rad);
  };
  EXPECT_NEAR(tilt_deg({0, 0, layout.valves[0].handle_height_m}), 8.2, 0.1);
  // Where the buttons stood in that layout; ours have moved by 5 mm since.
  const std::array<Vec2, 3> buttons_m{Vec2{-0.064, 0.137}, Vec2{0.0, 0.185}, Vec2{0.064, 0.137}};
  const std::array<double, 3> button_tilts{12.0, 13.7, 12.0};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(tilt_deg({buttons_m[i].x(), buttons_m[i].y(), layout.buttons[i].height_m}), button_tilts[i], 0.1);
}

TEST(Reach, CountsTheTiltAgainstATurnedPanel) {
  const PanelLayout layout;
  Pose base_from_panel = layout.nominal_base_from_panel();
  const Vec3 handle(0, 0, layout.valves[0].handle_height_m);
  const Vec3 at = base_from_panel * handle;
  const double square = reach(test::arm5e, base_from_panel, handle).tilt_rad;
  // The panel leant by 2 degrees about base y, the handle left where it is: the whole of it adds to the tilt, or takes from it.
  for (const double lean : {rad_from_deg(2), rad_from_deg(-2)}) {
    Pose leant = base_from_panel;
    leant.linear() = Eigen::AngleAxisd(lean, Vec3::UnitY()) * base_from_panel.linear();
    leant.translation() += at - leant * handle;
    EXPECT_NEAR(std::abs(reach(test::arm5e, leant, handle).tilt_rad - square), rad_from_deg(2), 1e-6);
  }
}

TEST(Reach, SaysWhyThePanelsCornersAreOutOfIt) {
  const PanelLayout layout;
  const Pose base_from_panel = layout.nominal_base_from_panel();
  EXPECT_NE(reach(test::arm5e, base_from_panel, {layout.plate_max_m.x(), layout.plate_min_m.y(), 0}).outcome, IkOutcome::ok);
  EXPECT_EQ(reach(test::arm5e, base_from_panel, {0, 0, std::nan("")}).outcome, IkOutcome::not_a_number);
}

}  // namespace
}  // namespace lf::arm
