// What a commissioning tells of what it has found.
#include "hal/vehicle/commissioner.hpp"

#include <gtest/gtest.h>

#include "hal/vehicle/operator_client.hpp"

namespace lf::hal {
namespace {

TEST(Commissioned, TheFrictionOfEachJointIsToldWithItsResidual) {
  config::HomingOffsets offsets;
  offsets.friction_known[2] = true;
  offsets.friction[2] = {2.5, 0.0125, 0.25};
  const Json friction = friction_json(offsets);
  EXPECT_EQ(friction, Json::parse(R"({"elbow": {"coulomb_mnm": 2.5, "viscous_mnm_s": 0.0125, "rms_mnm": 0.25}})"));

  const Json done{{"state", "done"}, {"zeros", {{"elbow", -37}, {"jaw", 0}}}, {"friction", friction}};
  EXPECT_EQ(commissioning_text(done),
            "elbow     zero at -37 counts; friction 2.5 mN m and 0.0125 mN m per rad/s at the motor, residual 0.25 mN m\n"
            "jaw       zero at 0 counts; friction not measured: as the arm's description has it\n");
}

}  // namespace
}  // namespace lf::hal
