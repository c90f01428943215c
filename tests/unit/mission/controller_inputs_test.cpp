// What the ports hand to the core and makes no sense is counted, and goes no further.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "firmware/controller.hpp"

namespace lf {
namespace {

PanelResult finite_result(Time measured) {
  PanelResult result;
  result.fit.plane.normal = Vec3::UnitZ();
  result.measured = measured;
  EXPECT_TRUE(result.markers.push_back({}));
  return result;
}

TEST(ControllerInputs, OfNoPortOfOursAreCounted) {
  const auto core = std::make_unique<Controller>(ControllerConfig{});
  core->on_can(bus_count, {}, Time{});
  EXPECT_EQ(core->rejected_inputs(), 1u);
  core->on_port_error(Port::count, 5, Time{});
  core->on_port_error(static_cast<Port>(200), 5, Time{});
  EXPECT_EQ(core->rejected_inputs(), 3u);
}

TEST(ControllerInputs, ThatAreNoNumbersAreCounted) {
  const auto core = std::make_unique<Controller>(ControllerConfig{});
  const Time now = Time{} + Duration::from_s(1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  core->on_panel(finite_result(now), now);
  EXPECT_EQ(core->rejected_inputs(), 0u);
  std::uint32_t wrong = 0;
  const auto refused = [&](const auto& change) {
    PanelResult result = finite_result(now);
    change(result);
    core->on_panel(result, now);
    EXPECT_EQ(core->rejected_inputs(), ++wrong);
  };
  refused([&](PanelResult& r) { r.fit.plane.normal.x() = nan; });
  refused([&](PanelResult& r) { r.fit.plane.offset_m = nan; });
  refused([&](PanelResult& r) { r.confidence = std::numeric_limits<float>::infinity(); });
  refused([&](PanelResult& r) { r.markers[0].camera_from_tag.translation().x() = nan; });
  refused([&](PanelResult& r) { r.measured = now + Duration::from_ms(1); });
}

}  // namespace
}  // namespace lf
