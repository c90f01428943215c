#include "hal/vehicle/friction_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace lf::hal {
namespace {

constexpr std::uint64_t seed = 10;

struct Screw {
  double coulomb, viscous, efficiency, back_efficiency;
  double load, load_slope, load_bend;  // over the stretch

  double torque(double place, double speed) const {
    const double weight = load + place * (load_slope + place * load_bend), way = speed > 0 ? 1 : -1;
    return weight * (weight * way > 0 ? 1 / efficiency : back_efficiency) + way * coulomb + viscous * speed;
  }
};

// There and back at two speeds, a sample every thousandth of the stretch.
FrictionFit passed(const Screw& screw, double noise, std::mt19937_64& engine) {
  std::normal_distribution<double> wrong(0, 1);
  FrictionFit fit;
  for (std::size_t pass = 0; pass < FrictionFit::passes; ++pass) {
    const double speed = (pass % 2 == 0 ? 1 : -1) * (pass < 2 ? 0.4 : 0.9);
    for (int i = 0; i < 1000; ++i) {
      const double place = (i + 0.5) / 1000;
      fit.add(pass, place, speed * (1 + 0.05 * wrong(engine)), screw.torque(place, speed) + noise * wrong(engine));
    }
  }
  return fit;
}

TEST(FrictionFit, FindsTheFrictionThatTheSamplesWereMadeWith) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> any(0, 1);
  for (int i = 0; i < 200; ++i) {
    const double efficiency = 0.6 + 0.4 * any(engine);
    const Screw screw{20 + 100 * any(engine), 60 * any(engine), efficiency, 2 - 1 / efficiency, 100 * (any(engine) - 0.5), 0, 0};
    const FoundFriction found = passed(screw, 0, engine).solve(screw.efficiency, screw.back_efficiency);
    ASSERT_TRUE(found.valid) << "seed " << seed << ", screw " << i;
    EXPECT_NEAR(found.coulomb, screw.coulomb, 0.6) << "seed " << seed << ", screw " << i;
    EXPECT_NEAR(found.viscous, screw.viscous, 0.8) << "seed " << seed << ", screw " << i;
  }
}

// A load that changes its sign on the way, and a reading with 4 thousandths of noise.
TEST(FrictionFit, TakesTheLoadOutOfTheFriction) {
  std::mt19937_64 engine(seed);
  const Screw screw{60, 40, 0.8, 0.75, -40, 120, -30};
  const FoundFriction found = passed(screw, 4, engine).solve(0.8, 0.75);
  ASSERT_TRUE(found.valid);
  EXPECT_NEAR(found.coulomb, 60, 2);
  EXPECT_NEAR(found.viscous, 40, 3);
  EXPECT_LT(found.rms, 3);
  // Who takes the screw for an ideal one sees a part of the load as friction, and is told by the residual.
  const FoundFriction ideal = passed(screw, 4, engine).solve(1, 1);
  EXPECT_GT(ideal.coulomb, 63);
  EXPECT_GT(ideal.rms, 1.5 * found.rms);
}

TEST(FrictionFit, SaysSoWhenThereIsTooLittleToTell) {
  FrictionFit fit;
  EXPECT_FALSE(fit.solve(0.8, 0.75).valid);
  for (int i = 0; i < 1000; ++i) fit.add(0, i / 1000.0, 0.5, 50);
  EXPECT_FALSE(fit.solve(0.8, 0.75).valid) << "one way only";
  std::mt19937_64 engine(seed);
  EXPECT_FALSE(passed({-30, 0, 0.8, 0.75, 0, 0, 0}, 1, engine).solve(0.8, 0.75).valid) << "torque with the motion is no friction";
  fit.add(9, 0.5, 1, 1);
  fit.add(0, std::numeric_limits<double>::quiet_NaN(), 1, 1);
  fit.add(0, 1.5, 1, 1);
}

}  // namespace
}  // namespace lf::hal
