#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/config/cause.hpp"

namespace lf::config {
namespace {

using testing::HasSubstr;

// The default marker as the docked camera sees it.
mission::CalibrationFit fit(float side_error, float corners_m) { return {true, 0.08f, 40, side_error, corners_m, 0.0003f, 0.001f}; }

TEST(CalibrationCause, IsNoneWhereTheMarkerFitsThePlane) {
  EXPECT_TRUE(calibration_cause({}, {}).name.empty());
  for (const float error : {-0.011f, 0.0f, 0.011f}) EXPECT_TRUE(calibration_cause(fit(error, 0.0005f), {}).name.empty()) << error;
}

// Printed at 97 % of its size, say.
TEST(CalibrationCause, NamesAMarkerThatIsNotAsLargeAsSurveyed) {
  EXPECT_THAT(calibration_cause(fit(0.03f, 0), {}).name, HasSubstr("off the surveyed one by +3.00 %, where 1.10 % are allowed"));
  EXPECT_THAT(calibration_cause(fit(-0.03f, 0), {}).name, HasSubstr("by -3.00 %"));
  EXPECT_THAT(calibration_cause(fit(-0.03f, 0), {}).remedy, HasSubstr("panel.marker_size_m"));
}

// Of 20 mm and 8 px: 0.2 mm of its survey and 0.2 px are a hundredth and a fortieth of it.
TEST(CalibrationCause, AllowsASmallMarkerMore) {
  EXPECT_TRUE(calibration_cause({true, 0.02f, 8, 0.038f, 0, 0, 0}, {}).name.empty());
  EXPECT_FALSE(calibration_cause({true, 0.02f, 8, 0.039f, 0, 0, 0}, {}).name.empty());
}

// 2 mm are a pixel here.
TEST(CalibrationCause, NamesCornersThatAreNoSquare) {
  EXPECT_TRUE(calibration_cause(fit(0, 0.0009f), {}).name.empty());
  EXPECT_THAT(calibration_cause(fit(0, 0.0016f), {}).name, HasSubstr("off a square by 0.80 px, where 0.50 are allowed"));
}

// Nothing was seen of it that could be told in pixels.
TEST(CalibrationCause, IsNoneWithoutASide) { EXPECT_TRUE(calibration_cause({true, 0.08f, 0, 0.5f, 1, 0, 0}, {}).name.empty()); }

mission::TaskResults felt(std::initializer_list<double> off_mm, StepFailure failure = StepFailure::none) {
  mission::TaskResults results;
  (void)results.push_back(mission::TaskResult{});  // a valve
  for (const double mm : off_mm) {
    mission::TaskResult press;
    press.face_felt = true;
    press.face_off_m = 1e-3 * mm;
    press.failure = failure;
    (void)results.push_back(press);
  }
  return results;
}

// Seen by the camera, felt by the arm: a plane at a wrong distance shows here whatever it is that put it there.
TEST(CalibrationCause, NamesFacesThatWereFeltElsewhereThanSeen) {
  EXPECT_EQ(faces_off_m(felt({})), std::nullopt);
  EXPECT_NEAR(*faces_off_m(felt({4, 5, 6})), 0.005, 1e-12);
  EXPECT_TRUE(calibration_cause({}, felt({4.5, -1})).name.empty());
  EXPECT_THAT(calibration_cause({}, felt({4, 5, 6})).name,
              HasSubstr("felt 5.0 mm behind the place where they were seen, where 4.7 mm are allowed"));
  EXPECT_THAT(calibration_cause({}, felt({-6})).name, HasSubstr("felt 6.0 mm before the place"));
  const Cause both = calibration_cause(fit(0.03f, 0), felt({-6}));
  EXPECT_THAT(both.name, HasSubstr("+3.00 %"));
  EXPECT_THAT(both.name, HasSubstr("; the buttons' faces"));
  EXPECT_TRUE(calibration_cause({}, felt({-20}, StepFailure::early_contact)).name.empty()) << "that was no face";
  EXPECT_FALSE(calibration_cause({}, felt({6}, StepFailure::button_yields)).name.empty()) << "that was one";
}

}  // namespace
}  // namespace lf::config
