// The default arm's figures by hand, from its URDF and the world's stiffness: what docs/faults.md says.
#include "host_sim/judge/gear_limits.hpp"

#include <gtest/gtest.h>

#include "host_sim/world/world.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::judge {
namespace {

constexpr const char* urdf_path = LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf";

TEST(GearLimits, OfTheDefaultArmAreThoseOfItsDrivesTorques) {
  const ArmDescription arm = load_arm_urdf(urdf_path);
  const world::WorldConfig world;
  // 56.4 N m by 1500 and by 4000, 9.7 and 44.9 by 1000 N m/rad, and half of the play: 0.35 mrad of a screw, 2 of a gear.
  const PerJoint<double> gives_rad{0.0378, 0.0143, 0.0143, 0.0107, 0.0459};
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    const GearLimits limits = gear_limits(arm.joints[i], world.drive_stiffness_nm_rad[i]);
    EXPECT_NEAR(limits.gives_rad, gives_rad[i], 2e-4) << arm.joints[i].name;
    EXPECT_EQ(limits.slips_rad, 0.5 * arm.joints[i].backlash_rad) << arm.joints[i].name << ": its gear holds what its drive does";
  }
}

TEST(GearLimits, OfAGearThatHoldsLessThanItsDriveAreWhatItHoldsAndTheRest) {
  ArmJoint jaw = load_arm_urdf(urdf_path).joints[4];
  jaw.holding_torque_nm = 20;
  EXPECT_NEAR(gear_limits(jaw, 1000).gives_rad, 0.001 + 0.020, 1e-6);
  EXPECT_NEAR(gear_limits(jaw, 1000).slips_rad, 0.001 + 0.0249, 1e-4);
}

}  // namespace
}  // namespace lf::judge
