#include "hal/vehicle/homing_changes.hpp"

#include <algorithm>

#include "shared/input_error.hpp"

namespace lf::hal {

JointSet either(JointSet one, const JointSet& other) {
  for (std::size_t i = 0; i < one.size(); ++i) one[i] = one[i] || other[i];
  return one;
}

bool any(const JointSet& joints) {
  return std::any_of(joints.begin(), joints.end(), [](bool one) { return one; });
}

std::string names_of(const JointSet& joints, const JointNames& names) {
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (joints[i]) all += (all.empty() ? "" : ", ") + names[i];
  }
  return all;
}

std::string write_offsets(const std::string& file, const config::HomingOffsets& offsets) {
  try {
    config::write_homing_file(file, offsets);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void forget_lost(const JointSet& lost, config::HomingOffsets& offsets, ControllerConfig& core) {
  for (std::size_t i = 0; i < core.network.drives.size(); ++i) {
    if (!lost[i]) continue;
    offsets.forget_zero(i);
    core.network.drives[i].zero_known = false;
  }
}

config::HomingOffsets with_doubts(config::HomingOffsets before, const JointSet& doubted, const config::HomingOffsets& taken_over,
                                  const ControllerConfig& core) {
  for (std::size_t i = 0; i < core.network.drives.size(); ++i) {
    if (!doubted[i]) continue;
    const canopen::DriveSetup& drive = core.network.drives[i];
    if (!before.has_earlier_zero(i) && drive.zero_known) {
      before.zero_counts[i] = drive.encoder_zero_counts;
      before.known[i] = true;
    }
    before.doubt_zero(i);
    if (!taken_over.friction_doubtful[i]) continue;
    before.doubt_friction(i);
    before.found[i] = taken_over.found[i];
  }
  return before;
}

Marks Marks::of(const JointSet& joints, const JointSet& lost, config::HomingOffsets file, const ControllerConfig& core) {
  JointSet compared{};
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (lost[i]) file.forget_zero(i);
    compared[i] = joints[i] && !lost[i];
  }
  return {joints, file, with_doubts(file, compared, file, core)};
}

config::HomingOffsets Marks::lifted_from(config::HomingOffsets file) const {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const bool as_marked = file.zero_doubtful[i] == marked.zero_doubtful[i] && file.known[i] == marked.known[i] &&
                           file.friction_doubtful[i] == marked.friction_doubtful[i] &&
                           (!file.zero_doubtful[i] || file.zero_counts[i] == marked.zero_counts[i]);
    if (joints[i] && as_marked) file.take_joint(before, i);
  }
  return file;
}

}  // namespace lf::hal
