#include "hal/config/panel_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace lf::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(PanelCheck, TheDefaultPanelIsFree) { EXPECT_THAT(panel_problems({}), IsEmpty()); }

// The plate's right edge lies at -170 + 50 mm, a button's own at 20 mm from its centre.
TEST(PanelCheck, AButtonOverTheMarkerIsNamedWithHowFar) {
  PanelLayout panel;
  panel.buttons[0].at_m = Vec2(-0.105, 0.072);
  EXPECT_THAT(panel_problems(panel), ElementsAre(HasSubstr("the left button covers the marker's plate by 5.0 mm")));
  panel.buttons[0].at_m = Vec2(-0.0999, 0.072);
  EXPECT_THAT(panel_problems(panel), IsEmpty());
  // At a corner the nearest point is the corner: 15 mm off along both axes are 21.2 mm.
  panel.buttons[0].at_m = Vec2(-0.120 + 0.015, 0.122 + 0.015);
  EXPECT_THAT(panel_problems(panel), Not(testing::Contains(HasSubstr("covers"))));
  panel.buttons[0].at_m = Vec2(-0.120 + 0.013, 0.122 + 0.013);
  EXPECT_THAT(panel_problems(panel), testing::Contains(HasSubstr("covers the marker's plate by 1.6 mm")));
}

TEST(PanelCheck, OverlappingButtonsAndWhatHangsBeyondThePlateAreNamed) {
  PanelLayout panel;
  panel.buttons[1].at_m = panel.buttons[0].at_m + Vec2(0.03, 0);
  EXPECT_THAT(panel_problems(panel), ElementsAre(HasSubstr("the centre button and the left one overlap by 10.0 mm")));
  panel = {};
  panel.buttons[2].at_m = Vec2(0.39, 0);
  EXPECT_THAT(panel_problems(panel),
              ElementsAre(HasSubstr("the right button hangs beyond the plate: see 'panel.plate_min_m', 'panel.plate_max_m'")));
  panel = {};
  panel.markers[0].centre_m = Vec2(-0.36, 0);
  EXPECT_THAT(panel_problems(panel), ElementsAre(HasSubstr("the marker's plate hangs beyond")));
}

// A bar turns about its middle: its corners are half of its diagonal away.
TEST(PanelCheck, WhatTheBarTurnsOverIsNamedWithHowFar) {
  PanelLayout panel;
  const PanelLayout::Valve& valve = panel.valves[0];
  const double bar_m = std::sqrt(valve.handle_length_m * valve.handle_length_m + valve.handle_thickness_m * valve.handle_thickness_m) / 2;
  panel.markers[0].centre_m = Vec2(-(bar_m + panel.markers[0].plate_m / 2 - 0.002), 0);
  EXPECT_THAT(panel_problems(panel), ElementsAre(HasSubstr("covers the marker's plate by 2.0 mm")));
  panel.markers[0].centre_m.x() -= 0.0021;
  EXPECT_THAT(panel_problems(panel), IsEmpty());
  panel = {};
  panel.buttons[0].at_m = Vec2(0, -(bar_m + panel.buttons[0].width_m / 2 - 0.003));
  EXPECT_THAT(panel_problems(panel), ElementsAre(HasSubstr("the left button lies 3.0 mm under the turning bar")));
  panel.buttons[0].at_m.y() -= 0.0031;
  EXPECT_THAT(panel_problems(panel), IsEmpty());
}

TEST(PanelCheck, TheLargestPlateIsTheLastThatIsAccepted) {
  PanelLayout panel;
  panel.markers[0].plate_m = largest_marker_plate_m(panel, panel.markers[0]) - 1e-6;
  EXPECT_TRUE(panel_problems(panel).empty());
  panel.markers[0].plate_m += 2e-6;
  EXPECT_FALSE(panel_problems(panel).empty());
}

Machine that_presses() {
  Machine machine;
  machine.tasks = {Task{Task::Kind::press_buttons}};
  return machine;
}

TEST(PanelCheck, ALowCapIsRefusedByTheNamesOfHeightStrokeAndOvertravel) {
  Machine machine = that_presses();
  EXPECT_THAT(low_button_problems(machine), IsEmpty());
  // The stroke of 5 mm, 6 mm of overtravel, a corner 28 mm from the middle of fingers that come at up to 13.5 + 7.5 degrees, and 3.6 mm of doubt. `lanternfish
  // reach` has 13.5.
  EXPECT_NEAR(lowest_button_m(machine, machine.panel.buttons[0]), 0.005 + 0.006 + 0.028 * std::sin(rad_from_deg(13.5 + 7.5)) + 0.0036,
              0.0001);
  for (PanelLayout::Button& button : machine.panel.buttons) button.height_m = 0.0240;
  for (const char* part : {"'panel.button_height_m' is 0.024", "'panel.button_stroke_m'", "'mission.press_overtravel_m'", "0.02",
                           "'panel.buttons_m'", "up to 21.", "degrees aslant", "'panel.right_m' 0", "'mission.docking_rad' at 0.0349"})
    EXPECT_THAT(low_button_problems(machine), ElementsAre(HasSubstr(part)));
  machine.tasks = {Task{}};
  EXPECT_THAT(low_button_problems(machine), IsEmpty()) << "none is pressed";
  machine = that_presses();
  for (PanelLayout::Button& button : machine.panel.buttons) button.stroke_m = 0.02;
  EXPECT_THAT(low_button_problems(machine), ElementsAre(HasSubstr("'panel.button_height_m'")));
}

// The farther off a button is the more aslant the fingers come: 18.3 degrees here, and 13.5, by `lanternfish reach`.
TEST(PanelCheck, ABoxThatStandsFarOffNeedsHigherCaps) {
  Machine near = that_presses(), far = near;
  far.panel.nominal_z_m = 0.55;
  EXPECT_NEAR(lowest_button_m(far, far.panel.buttons[0]) - lowest_button_m(near, near.panel.buttons[0]),
              0.028 * (std::sin(rad_from_deg(18.3 + 7.5)) - std::sin(rad_from_deg(13.5 + 7.5))), 0.0001);
}

// What is touched more than 8 mm below the bottom is not taken for the button, however far the press goes on.
TEST(PanelCheck, ALongOvertravelAsksForNoMoreThanWhatPassesForTheButton) {
  const auto lowest_m = [](double overtravel_m) {
    Machine machine;
    machine.mission.press_overtravel_m = overtravel_m;
    return lowest_button_m(machine, machine.panel.buttons[0]);
  };
  EXPECT_EQ(lowest_m(0.008), lowest_m(0.05));
  EXPECT_LT(lowest_m(0.002), lowest_m(0.008));
}

}  // namespace
}  // namespace lf::config
