// An arm's URDF: a chain whose figures can be used, or an InputError.
#include <cmath>

#include "shared/arm/arm_description.hpp"
#include "shared/arm/make_model.hpp"
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
    const lf::ArmModel model = lf::make_model(arm);
    lf::fuzz::expect(std::isfinite(model.planar.a0_m + model.planar.a2_m + model.planar.d_m) && model.planar.a1_m > 0,
                     "the core's lengths are numbers");
    lf::fuzz::expect(model.capsules.size() <= model.capsules.capacity(), "no shape is left out");
    for (const lf::ArmModel::Capsule& capsule : model.capsules)
      lf::fuzz::expect(capsule.radius_m() > 0 && (capsule.a_m() + capsule.b_m()).allFinite(), "a capsule's figures are numbers");
    for (const lf::ArmLink& link : arm.links) lf::fuzz::expect(link.mass_kg > 0 && std::isfinite(link.wet_weight_n), "a link has mass");
  } catch (const lf::InputError& refused) {
    lf::fuzz::expect(refused.what()[0] != '\0', "a refusal says why");
  }
  return 0;
}
