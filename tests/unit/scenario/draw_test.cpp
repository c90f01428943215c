#include "host_sim/scenario/draw.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/temporary_folder.hpp"

namespace lf::scenario {

TEST(Draw, EveryQuantityStaysWithinItsSpread) {
  const Scenario s;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    const Sample sample = draw(s, seed);
    EXPECT_LE(sample.docking_shift_m.cwiseAbs().maxCoeff(), 0.020);
    EXPECT_LE(sample.docking_turn_rad.cwiseAbs().maxCoeff(), rad_from_deg(2));
    EXPECT_LE(std::abs(sample.valves[0].start_rad), rad_from_deg(40));
    EXPECT_GE(sample.valves[0].friction_nm, 0.5);
    EXPECT_LE(sample.valves[0].friction_nm, 3.0);
    EXPECT_GE(sample.attenuation_per_m, 0.1);
    EXPECT_LE(sample.attenuation_per_m, 0.8);
    EXPECT_GE(sample.camera_noise_grey, 1);
    EXPECT_LE(sample.camera_noise_grey, 3);
    EXPECT_LE(sample.camera_shift_m.cwiseAbs().maxCoeff(), 0.0002);
    EXPECT_LE(sample.laser_turn_rad.cwiseAbs().maxCoeff(), rad_from_deg(0.05));
    for (const double offset : sample.joint_offset_rad) EXPECT_LE(std::abs(offset), rad_from_deg(0.05));
    EXPECT_EQ(sample.markers[0].shift_m.z(), 0);
  }
}

// Kolmogorov-Smirnov at the 0.1 % level: the largest gap to the uniform distribution is below 1.95 / sqrt(n).
TEST(Draw, IsUniformAndQuantitiesAreIndependentOfEachOther) {
  constexpr int n = 20000;
  std::vector<double> a, b;
  double product = 0;
  for (std::uint64_t seed = 0; seed < n; ++seed) {
    a.push_back(uniform(seed, "valve.friction_nm"));
    b.push_back(uniform(seed, "valve.start_deg"));
    product += (a.back() - 0.5) * (b.back() - 0.5);
  }
  EXPECT_LT(std::abs(12 * product / n), 4.0 / std::sqrt(n)) << "correlation, four sigma";
  std::sort(a.begin(), a.end());
  double gap = 0;
  for (int i = 0; i < n; ++i) gap = std::max(gap, std::abs(a[static_cast<std::size_t>(i)] - (i + 0.5) / n));
  EXPECT_LT(gap, 1.95 / std::sqrt(n));
}

TEST(Draw, ChanceIsEvenAndFixedOnesAreFixed) {
  Scenario s;
  int lit = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) lit += draw(s, seed).lamps_lit ? 1 : 0;
  EXPECT_NEAR(lit, 1000, 100);
  s.lamps.lit = Chance::yes;
  EXPECT_TRUE(draw(s, 1).lamps_lit);
  s.lamps.lit = Chance::no;
  EXPECT_FALSE(draw(s, 1).lamps_lit);
}

TEST(Draw, WhatOneQuantityIsDoesNotChangeTheOthers) {
  Scenario changed;
  changed.valve.friction_nm = Spread::fixed(1);
  changed.docking.x_m = Spread::around(0, 0.4);
  for (std::uint64_t seed = 1; seed < 50; ++seed) {
    const Sample a = draw(Scenario(), seed), b = draw(changed, seed);
    EXPECT_EQ(a.valves[0].start_rad, b.valves[0].start_rad) << seed;
    EXPECT_EQ(a.docking_shift_m.y(), b.docking_shift_m.y()) << seed;
    EXPECT_EQ(a.optics_seed, b.optics_seed) << seed;
  }
}

// A generator that changes by accident would silently change what every seed means. The constants are splitmix64(splitmix64(seed) ^ FNV-1a(name)) worked
// out in Python with integers; the published first output of splitmix64 from state 0 is 0xe220a8397b1dcdaf.
TEST(Draw, SeedsMeanTheSameForEver) {
  EXPECT_EQ(bits(1, "valve.start_deg"), 0xba677d3de0e6fddcull);
  EXPECT_EQ(bits(42, "docking.x_m"), 0xf7de119a2b1a9168ull);
  EXPECT_EQ(bits(0, ""), 0x5b21f68ffa77f14cull);
}

TEST(Draw, TheSensorsSeedCanBeHeldWhileTheRestVaries) {
  Scenario s;
  s.sensors.seed = 7;
  EXPECT_EQ(draw(s, 1).optics_seed, draw(s, 2).optics_seed);
  EXPECT_NE(draw(s, 1).valves[0].start_rad, draw(s, 2).valves[0].start_rad);
  EXPECT_NE(draw(s, 1).optics_seed, draw(s, 1).devices_seed);
}

// What is drawn of a file's feature has its name: another one beside it, or one less, changes nothing.
TEST(Draw, OfAFilesFeatureIsTheSameWhateverIsBesideIt) {
  const test::TemporaryFolder folder;
  const std::string v2 = "{name: V2, at_m: [0.2, 0]}", b2 = "{name: B2, at_m: [0.067, 0.141]}", m9 = "{id: 9, at_m: [0.3, 0.1]}";
  const auto scenario = [&](const std::string& valves, const std::string& buttons, const std::string& markers) {
    folder.write("panel.yaml", "version: 1\nvalves: [" + valves + "]\nbuttons: [" + buttons + "]\nmarkers: [" + markers + "]\n");
    return load_scenario("default", {"panel.file=" + folder / "panel.yaml", "tasks=[turn_valve: {valve: V2, to_deg: 10}]"});
  };
  const Scenario alone = scenario(v2, b2, m9);
  const Scenario among =
      scenario("{name: V1, at_m: [0, 0]}, " + v2, "{name: B1, at_m: [-0.067, 0.141]}, " + b2, "{id: 7, at_m: [-0.17, 0.072]}, " + m9);
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const Sample a = draw(alone, seed), b = draw(among, seed);
    ASSERT_EQ(a.valves.size() + a.buttons.size() + a.markers.size(), 3u);
    ASSERT_EQ(b.valves.size() + b.buttons.size() + b.markers.size(), 6u);
    EXPECT_EQ(a.valves[0].start_rad, b.valves[1].start_rad);
    EXPECT_EQ(a.valves[0].friction_nm, b.valves[1].friction_nm);
    EXPECT_EQ(a.valves[0].size_m, b.valves[1].size_m);
    EXPECT_EQ(a.buttons[0].shift_m, b.buttons[1].shift_m);
    EXPECT_EQ(a.markers[0].shift_m, b.markers[1].shift_m);
    EXPECT_EQ(a.optics_seed, b.optics_seed);
    EXPECT_NE(b.valves[0].start_rad, b.valves[1].start_rad) << "each has its own";
    EXPECT_NE(b.buttons[0].shift_m, b.buttons[1].shift_m);
    EXPECT_NE(b.markers[0].shift_m, b.markers[1].shift_m);
  }
}

}  // namespace lf::scenario
