#include "hal/config/motor_check.hpp"

#include <algorithm>
#include <cstdio>

#include "firmware/canopen/setup.hpp"
#include "hal/config/homing_file.hpp"
#include "shared/arm/motor.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

void check_motor(const JointDriveChoice& choice, std::size_t joint, const ArmJoint& description, const std::string& where) {
  constexpr double direct_drive = 0.999;  // a ratio of 1, computed
  char text[320];
  const double ratio = best_motor_ratio(description, choice.counts_per_rev);
  if (ratio < direct_drive) {
    std::snprintf(
        text, sizeof text,
        "'counts_per_rev' is %.6g: the motor would turn %.3g times for a turn of the joint, and a gear slows down. It is how many of the "
        "arm's counts (%.4g to a radian of the %s at most) go to a revolution of the motor, not the encoder's resolution",
        choice.counts_per_rev, ratio, ratio * choice.counts_per_rev / (2 * pi), joint_name(joint));
    throw InputError(where + ": " + text);
  }
  if (choice.counts_per_rev < fewest_counts_per_rev) {
    std::snprintf(
        text, sizeof text,
        "'counts_per_rev' is %.6g: the motor would turn %.3g times for a turn of the joint. At least %g counts are needed: with a "
        "higher gear free motions are taken for contacts",
        choice.counts_per_rev, ratio, fewest_counts_per_rev);
    throw InputError(where + ": " + text);
  }
  if (choice.rated_torque_nm == 0) return;
  const double expected_nm = motor_of(description, choice.counts_per_rev).rated_torque_nm;
  if (choice.rated_torque_nm <= canopen::same_motor_factor * expected_nm &&
      choice.rated_torque_nm >= expected_nm / canopen::same_motor_factor)
    return;
  std::snprintf(
      text, sizeof text,
      "'rated_torque_nm' is %.4g N m: the arm's description rates the joint at %.4g N m, which is %.4g N m at the motor, through a ratio "
      "of %.4g. "
      "State the motor's own rated torque, without its gear; if this motor is right, correct the rated torque of the arm's description",
      choice.rated_torque_nm, description.rated_torque_nm, expected_nm, ratio);
  throw InputError(where + ": " + text);
}

void check_position_unit(const JointDriveChoice& choice, std::size_t joint, const ArmJoint& description,
                         const canopen::Ratio& units_per_count, const std::string& where) {
  constexpr double coarsest_rad = 0.001, coarsest_counts = 2;
  const double counts_per_rad = best_motor_ratio(description, choice.counts_per_rev) * choice.counts_per_rev / (2 * pi);
  const double counts = double(units_per_count.den) / units_per_count.num;
  if (counts <= std::max(coarsest_counts, coarsest_rad * counts_per_rad)) return;
  char text[320];
  std::snprintf(
      text, sizeof text,
      "its profile makes a unit of the drive's positions of %.4g of the arm's counts, %.3g mrad of the %s. At most 1 mrad or two counts "
      "are "
      "allowed: a joint that is left behind could not be told from one that follows. Set a finer position unit in the drive and in its "
      "profile, or check 'counts_per_rev'",
      counts, 1000 * counts / counts_per_rad, joint_name(joint));
  throw InputError(where + ": " + text);
}

}  // namespace lf::config
