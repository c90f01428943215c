#include "host_sim/app/observers/calibration_observer.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lf::app {
namespace {

Telemetry look(std::uint32_t number, const mission::CalibrationFit& fit) {
  Telemetry telemetry;
  telemetry.sight.look = number;
  telemetry.sight.fit = fit;
  return telemetry;
}

TEST(CalibrationObserver, HasNothingWithoutALookThatFoundMarkerAndPlane) {
  CalibrationObserver observer;
  observer.on_telemetry(look(0, {}));
  observer.on_telemetry(look(1, {}));
  EXPECT_FALSE(observer.record().has_value());
}

TEST(CalibrationObserver, KeepsTheLargestOfEachAndTheLookThatFitsWorst) {
  CalibrationObserver observer;
  observer.on_telemetry(
      look(1, {.known = true, .marker_size_m = 0.08f, .marker_side_px = 40, .marker_side_error = 0.02f, .marker_corners_m = 0.0001f}));
  ASSERT_TRUE(observer.record().has_value());
  EXPECT_TRUE(std::isnan(observer.record()->panel_shift_mm)) << "there is no look before";
  // Smaller in its sum, and farther beyond what it may be: the marker is larger in the picture.
  const mission::CalibrationFit near{.known = true,
                                     .marker_size_m = 0.08f,
                                     .marker_side_px = 400,
                                     .marker_side_error = -0.019f,
                                     .marker_corners_m = 0.0003f,
                                     .panel_shift_m = 0.001f};
  observer.on_telemetry(look(2, near));
  observer.on_telemetry(look(2, {.known = true, .marker_size_m = 0.08f, .marker_side_px = 40, .marker_side_error = 0.5f}));
  EXPECT_NEAR(observer.record()->marker_side_percent, 2, 1e-5) << "a look is taken once";
  EXPECT_NEAR(observer.record()->marker_corners_mm, 0.3, 1e-5);
  EXPECT_NEAR(observer.record()->panel_shift_mm, 1, 1e-5);
  EXPECT_EQ(observer.worst_fit().marker_side_px, 400);
}

}  // namespace
}  // namespace lf::app
