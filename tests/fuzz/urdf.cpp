// An arm's URDF: a chain whose figures can be used, or an InputError.
#include <cmath>

#include "shared/arm/arm_description.hpp"
#include "shared/input_error.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static lf::fuzz::MemoryFile file;
  try {
    const lf::ArmDescription arm = lf::load_arm_urdf(file.holding({data, size}));
    for (const lf::ArmJoint& joint : arm.joints) {
      lf::fuzz::expect(joint.lower_rad < joint.upper_rad && joint.effort_nm > 0 && joint.velocity_rad_s > 0, "a joint can move");
      lf::fuzz::expect(joint.parent_from_joint.matrix().allFinite(), "a joint's place is numbers");
    }
    for (const lf::ArmLink& link : arm.links) lf::fuzz::expect(link.mass_kg > 0 && std::isfinite(link.wet_weight_n), "a link has mass");
  } catch (const lf::InputError& refused) {
    lf::fuzz::expect(refused.what()[0] != '\0', "a refusal says why");
  }
  return 0;
}
