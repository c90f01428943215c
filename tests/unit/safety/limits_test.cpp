#include "firmware/safety/limits.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/arm5e_joints.hpp"

namespace lf::safety {
namespace {

Limits good_limits() {
  Limits limits;
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_TRUE(limits.joints.push_back({-1.0 - static_cast<double>(i), 1.5, 0.5, 20}));
  limits.workspace_min_m = {-0.5, -0.5, -0.5};
  limits.workspace_max_m = {0.5, 0.5, 1.0};
  limits.stale_position_s = 0.012;
  limits.stale_image_s = 0.2;
  limits.vision_timeout_s = 2;
  limits.max_contact_torque_nm = 25;
  limits.checksum = limits_checksum(limits);
  return limits;
}

TEST(Limits, ChecksumIsTheCrcThatOthersCompute) {
  // python3 -c "import struct, zlib; print(hex(zlib.crc32(struct.pack('<30d', *([v for i in range(5) for v in (-1.0 - i, 1.5, 0.5, 20)]
  //   + [-0.5] * 3 + [0.5, 0.5, 1.0] + [0.012, 0.2, 2, 25])))))"
  EXPECT_EQ(limits_checksum(good_limits()), 0x1F0CF979u);
}

TEST(Limits, GoodOnesPass) { EXPECT_EQ(check(good_limits()), LimitsVerdict::good); }

TEST(Limits, AnyChangedBitIsNoticed) {
  for (int bit = 0; bit < 64; ++bit) {
    Limits limits = good_limits();
    auto* bytes = reinterpret_cast<unsigned char*>(&limits.joints[3].max_torque_nm);
    bytes[bit / 8] = static_cast<unsigned char>(bytes[bit / 8] ^ (1u << (bit % 8)));
    EXPECT_NE(check(limits), LimitsVerdict::good) << "bit " << bit;
  }
}

TEST(Limits, ImpossibleOnesAreRefusedWithARightChecksum) {
  Limits limits = good_limits();
  limits.joints[1].min_rad = std::numeric_limits<double>::quiet_NaN();
  limits.checksum = limits_checksum(limits);
  EXPECT_EQ(check(limits), LimitsVerdict::not_a_number);

  limits = good_limits();
  limits.joints[4].min_rad = 2;
  limits.checksum = limits_checksum(limits);
  EXPECT_EQ(check(limits), LimitsVerdict::out_of_order);

  limits = good_limits();
  limits.workspace_max_m[1] = -0.6;
  limits.checksum = limits_checksum(limits);
  EXPECT_EQ(check(limits), LimitsVerdict::out_of_order);

  limits = good_limits();
  limits.joints[0].max_speed_rad_s = 0;
  limits.checksum = limits_checksum(limits);
  EXPECT_EQ(check(limits), LimitsVerdict::not_positive);

  for (double Limits::*number :
       {&Limits::stale_position_s, &Limits::stale_image_s, &Limits::vision_timeout_s, &Limits::max_contact_torque_nm}) {
    limits = good_limits();
    limits.*number = 0;
    limits.checksum = limits_checksum(limits);
    EXPECT_EQ(check(limits), LimitsVerdict::not_positive);
  }
}

TEST(Limits, AnExcursionIsTheFarthestOfTheThreeAxes) {
  const Limits limits = good_limits();  // x and y -0.5 to 0.5, z -0.5 to 1.0
  EXPECT_EQ(workspace_excursion_m(limits, {0, 0, 0}), 0);
  EXPECT_EQ(workspace_excursion_m(limits, {0.5, -0.5, 1.0}), 0);
  EXPECT_NEAR(workspace_excursion_m(limits, {0.6, -0.8, 1.1}), 0.3, 1e-12);
  EXPECT_GT(workspace_excursion_m(limits, {std::numeric_limits<double>::quiet_NaN(), 0, 0}), 1e9);
}

TEST(Limits, AMissionMayTightenEachButWidenNone) {
  const Limits outer = good_limits();
  EXPECT_TRUE(is_tighter(outer, outer));
  const auto changed = [&](auto change) {
    Limits limits = outer;
    change(limits);
    return is_tighter(limits, outer);
  };
  EXPECT_TRUE(changed([](Limits& l) { l.joints[2].max_rad -= 0.1; }));
  EXPECT_FALSE(changed([](Limits& l) { l.joints[2].max_rad += 0.1; }));
  EXPECT_TRUE(changed([](Limits& l) { l.joints[2].min_rad += 0.1; }));
  EXPECT_FALSE(changed([](Limits& l) { l.joints[2].min_rad -= 0.1; }));
  EXPECT_FALSE(changed([](Limits& l) { l.joints[0].max_speed_rad_s *= 1.01; }));
  EXPECT_FALSE(changed([](Limits& l) { l.joints[0].max_torque_nm *= 1.01; }));
  EXPECT_FALSE(changed([](Limits& l) { l.workspace_max_m[0] += 0.01; }));
  EXPECT_FALSE(changed([](Limits& l) { l.workspace_min_m[0] -= 0.01; }));
  EXPECT_FALSE(changed([](Limits& l) { l.stale_position_s *= 2; }));
  EXPECT_FALSE(changed([](Limits& l) { l.vision_timeout_s *= 2; }));
  EXPECT_FALSE(changed([](Limits& l) { l.max_contact_torque_nm *= 2; }));
  EXPECT_FALSE(changed([](Limits& l) { l.joints[0].max_rad = std::numeric_limits<double>::quiet_NaN(); }));
}

}  // namespace
}  // namespace lf::safety
