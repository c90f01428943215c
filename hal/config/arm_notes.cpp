#include "hal/config/arm_notes.hpp"

#include "shared/arm/arm_description.hpp"

namespace lf::config {

std::vector<std::string> arm_notes(const std::string& urdf_file) {
  const ArmDescription arm = load_arm_urdf(urdf_file);
  std::vector<std::string> notes = arm.notes;
  std::string frictionless;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    if (!arm.joints[i].friction.stated) frictionless += (frictionless.empty() ? "" : ", ") + arm.joints[i].name;
  }
  if (frictionless.empty()) return notes;
  notes.push_back(
      urdf_file + ": no <lanternfish:friction> for " + frictionless +
      ": there, motor and gear are taken to have no friction, in the simulator and in the core. `lanternfishd commission` measures a "
      "real joint's");
  return notes;
}

}  // namespace lf::config
