#include "hal/sim/shutter.hpp"

#include <gtest/gtest.h>

namespace lf::hal {
namespace {

constexpr Duration step = Duration::from_ms(1);

// Steps of a millisecond from 0 on; the laser is on from `on` to `off`.
Shutter after(Shutter shutter, Time end, Time on, Time off) {
  for (Time t; t < end; t = t + step) shutter.pass(t, t + step, t >= on && t < off, false);
  return shutter;
}

Time ms(std::int64_t value) { return Time() + Duration::from_ms(value); }

TEST(Shutter, LightThatIsOnThroughoutHasAllOfTheExposure) {
  const Shutter shutter = after({ms(4), Duration::from_us(300), Duration::from_ms(2)}, ms(10), ms(0), ms(100));
  EXPECT_FLOAT_EQ(shutter.laser_share(), 1);
  EXPECT_FLOAT_EQ(shutter.lamp_share(), 0);
}

TEST(Shutter, LightThatIsSwitchedMeanwhileHasItsShare) {
  EXPECT_FLOAT_EQ(after({ms(4), Duration(), Duration::from_ms(5)}, ms(20), ms(0), ms(8)).laser_share(), 0.8f) << "off after 4 of 5 ms";
  EXPECT_FLOAT_EQ(after({ms(4), Duration(), Duration::from_ms(5)}, ms(20), ms(8), ms(50)).laser_share(), 0.2f);
  // The shutter's delay pushes a quarter of the exposure behind the switch.
  EXPECT_FLOAT_EQ(after({ms(4), Duration::from_us(500), Duration::from_ms(2)}, ms(20), ms(0), ms(6)).laser_share(), 0.75f);
}

TEST(Shutter, ClosesWhenItsTimeIsOver) {
  const Shutter shutter(ms(4), Duration::from_us(300), Duration::from_ms(2));
  EXPECT_FALSE(shutter.closed(ms(6)));
  EXPECT_TRUE(shutter.closed(ms(6) + Duration::from_us(300)));
  EXPECT_EQ(shutter.middle(), ms(5) + Duration::from_us(300));
}

TEST(Shutter, OneThatNeverOpensHasNoLight) {
  EXPECT_FLOAT_EQ(after({ms(4), Duration(), Duration()}, ms(20), ms(0), ms(50)).laser_share(), 0);
}

}  // namespace
}  // namespace lf::hal
