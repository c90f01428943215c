#include "hal/config/cause.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "hal/config/fault_text.hpp"

namespace lf::config {
namespace {

using mission::Sight;
using testing::HasSubstr;
using testing::Not;

// A look at a panel in its place in clear water: two thirds of the columns have a stripe.
Sight good_look() {
  Sight sight;
  sight.look = 1;
  sight.stripes = 200;
  sight.columns_found = 85'000;
  sight.columns_weak = 43'000;
  sight.points = 80'000;
  sight.plane_found = true;
  sight.inliers = 70'000;
  sight.plane_off_m = 0.008f;
  sight.still_taken = true;
  sight.still = {90, 30, 0};
  sight.marker_found = true;
  sight.marker_cell_px = 4;
  sight.marker_off_m = 0.012f;
  sight.proud_clusters = 4;
  sight.handle_found = true;
  sight.handle_off_m = 0.01f;
  return sight;
}

std::string cause(StepFailure failure, const Sight& sight) { return sight_cause(failure, sight).name; }

TEST(SightCause, NamesWhatAFailedLookSaw) {
  Sight dark = good_look();
  dark.marker_found = dark.plane_found = false;
  dark.still = {2, 0.5f, 0};
  EXPECT_EQ(cause(StepFailure::no_panel, dark), "the pictures are dark");
  EXPECT_EQ(cause(StepFailure::no_marker, dark), "the pictures are dark");

  Sight white = dark;
  white.still = {250, 1, 0.9f};
  EXPECT_EQ(cause(StepFailure::no_panel, white), "the pictures are white");

  Sight haze = dark;
  haze.still = {60, 1, 0};
  haze.columns_found = 500;
  haze.columns_weak = 127'500;
  EXPECT_EQ(cause(StepFailure::no_panel, haze), "the water is too turbid");
  EXPECT_EQ(cause(StepFailure::no_marker, haze), "the water is too turbid");

  Sight hidden = good_look();
  hidden.marker_found = false;
  EXPECT_EQ(cause(StepFailure::no_marker, hidden), "the marker is hidden or another one");
  hidden.handle_found = false;
  EXPECT_EQ(cause(StepFailure::no_marker, hidden), "neither marker nor handle is at its place");

  Sight small = good_look();
  small.marker_found = false;
  small.marker_cell_px = 1.7f;
  EXPECT_EQ(cause(StepFailure::no_marker, small), "the marker is too small in the picture: 1.7 px a square of its code");

  Sight noisy = good_look();
  noisy.marker_found = noisy.handle_found = false;
  noisy.still = {55, 30, 0, 30};
  for (const StepFailure failure : {StepFailure::no_panel, StepFailure::no_marker, StepFailure::no_handle})
    EXPECT_EQ(cause(failure, noisy), "the pictures are noisy: 30 grey levels");
  noisy.still = {55, 5, 0, 12};
  EXPECT_EQ(cause(StepFailure::no_marker, noisy), "the water is too turbid") << "what looks like contrast is noise";

  Sight without_line = good_look();
  without_line.plane_found = without_line.handle_found = false;
  without_line.points = 3;
  EXPECT_EQ(cause(StepFailure::no_panel, without_line), "the laser's line is missing or too weak");
  without_line.marker_found = false;
  EXPECT_EQ(cause(StepFailure::no_panel, without_line), "neither marker nor handle is at its place");

  Sight silent;
  silent.look = 1;
  EXPECT_EQ(cause(StepFailure::no_panel, silent), "no pictures came");
  silent.images_refused = 12;
  EXPECT_EQ(cause(StepFailure::no_panel, silent), "the pictures were refused");
  silent.points = 80'000;
  EXPECT_EQ(cause(StepFailure::no_marker, silent), "") << "given sight was not made of pictures";
}

TEST(SightCause, SaysByHowMuchThePanelIsOff) {
  Sight far = good_look();
  far.marker_found = false;
  far.plane_off_m = 0.497f;
  EXPECT_EQ(cause(StepFailure::no_marker, far), "the panel stands 497 mm off its nominal place");
  Sight aside = good_look();
  aside.marker_off_m = 0.5f;
  for (const StepFailure failure : {StepFailure::unreachable, StepFailure::panel_in_the_way, StepFailure::no_handle})
    EXPECT_EQ(cause(failure, aside), "the panel stands 500 mm off its nominal place");
  Sight beside = good_look();
  beside.marker_found = false;
  beside.handle_off_m = 0.3f;
  EXPECT_EQ(cause(StepFailure::no_marker, beside), "the panel stands 300 mm off its nominal place");
  Sight askew = good_look();
  askew.plane_tilt_rad = 0.2f;
  askew.marker_found = false;
  EXPECT_THAT(cause(StepFailure::no_marker, askew), HasSubstr("tilted by 11.5 degrees"));
}

// What a look can say nothing about keeps the words of its failure.
TEST(SightCause, NamesNothingWhereTheNumbersTellNothing) {
  EXPECT_EQ(cause(StepFailure::no_marker, Sight{}), "") << "no look was answered";
  EXPECT_EQ(cause(StepFailure::unreachable, good_look()), "");
  EXPECT_EQ(cause(StepFailure::slipped, good_look()), "");
  EXPECT_EQ(cause_of(safety::Fault::step_failed, static_cast<std::int32_t>(StepFailure::slipped), good_look()).name,
            "the handle slipped in the jaw");
  Sight chance = good_look();
  chance.marker_found = false;
  chance.points = 1000;
  chance.inliers = 90;
  chance.plane_off_m = 0.4f;
  EXPECT_EQ(cause(StepFailure::no_marker, chance), "the marker is hidden or another one") << "a plane of a tenth of the points is no panel";
}

TEST(Cause, EveryFaultHasARemedyOrIsAnOrder) {
  for (std::size_t i = 0; i < safety::fault_count; ++i) {
    const auto fault = static_cast<safety::Fault>(i);
    const Cause cause = cause_of(fault, static_cast<std::int32_t>(StepFailure::no_marker), {});
    EXPECT_EQ(cause.remedy.empty(), fault == safety::Fault::aborted) << safety::name(fault);
  }
}

TEST(Cause, IsInTheTextThatEveryProgramSays) {
  Sight hidden = good_look();
  hidden.marker_found = false;
  const std::string text = fault_text(safety::Fault::vision_poor, static_cast<std::int32_t>(StepFailure::no_marker), 0, {}, hidden);
  EXPECT_THAT(text, HasSubstr("panel vision unsure: no usable marker seen: the marker is hidden or another one ("));
  EXPECT_THAT(text, HasSubstr("panel.marker_id"));
  EXPECT_EQ(fault_text(safety::Fault::drive_fault, 2, 0, {}, hidden), "drive fault: elbow");
}

TEST(SightText, HasTheNumbersThatTheCauseIsToldBy) {
  EXPECT_EQ(sight_text({}), "");
  const std::string text = sight_text(good_look());
  EXPECT_THAT(text, HasSubstr("200 images of the laser, peaks in 66 % of their columns"));
  EXPECT_THAT(text, HasSubstr("80000 points, 70000 on a plane +8 mm"));
  EXPECT_THAT(text,
              HasSubstr("still: mean 90 grey, contrast 30.0, noise 0.0, 0 % white, marker 12 mm off its nominal place, handle 10 mm"));
  EXPECT_THAT(text, Not(HasSubstr("missing")));
}

}  // namespace
}  // namespace lf::config
