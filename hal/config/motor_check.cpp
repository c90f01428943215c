#include "hal/config/motor_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "firmware/canopen/setup.hpp"
#include "shared/arm/motor.hpp"
#include "shared/input_error.hpp"

namespace lf::config {
namespace {

// To four decimals: what is advised is taken.
double rounded_up(double value) { return std::ceil(value * 1e4) / 1e4; }

}  // namespace

void check_motor(const JointDriveChoice& choice, const ArmJoint& description, const std::string& where) {
  constexpr double direct_drive = 0.999;  // a ratio of 1, computed
  char text[448];
  const double ratio = best_motor_ratio(description, choice.counts_per_rev);
  if (ratio < direct_drive) {
    std::snprintf(
        text, sizeof text,
        "'counts_per_rev' is %.6g: the motor would turn %.3g times for a turn of the joint, and a gear slows down. It is how many of the "
        "arm's counts (%.4g to a radian of the %s at most) go to a revolution of the motor, and at most %.5g. The encoder's resolution is "
        "position.units_per_rev of the drive's profile",
        choice.counts_per_rev, ratio, ratio * choice.counts_per_rev / (2 * pi), description.name.c_str(),
        std::floor(ratio * choice.counts_per_rev));
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

void check_position_unit(const JointDriveChoice& choice, const ArmJoint& description, const DriveKind& kind, const std::string& where) {
  constexpr double coarsest_rad = 0.001;
  const double counts = kind.position.per_count > 0 ? 1 / kind.position.per_count : choice.counts_per_rev / kind.position.per_rev;
  // Where a count turns the joint farthest.
  const double counts_per_rad = least_motor_ratio(description, choice.counts_per_rev) * choice.counts_per_rev / (2 * pi);
  const double most = std::max(1.0, coarsest_rad * counts_per_rad);
  if (counts <= most) return;
  char text[512];
  int used = std::snprintf(
      text, sizeof text,
      "one unit of the drive's positions is %.6g of the arm's counts, which is %.4g mrad of the %s where it is most. It may be 1 mrad, or "
      "one count where that is more: a joint that stays behind could not be told from one that follows. Set a finer unit in the drive, and "
      "state it in its profile: ",
      counts, 1000 * counts / counts_per_rad, description.name.c_str());
  const std::size_t left = sizeof text - static_cast<std::size_t>(used);
  if (kind.position.per_count > 0)
    std::snprintf(text + used, left, "position.units_per_count of %.4f or more", rounded_up(1 / most));
  else
    std::snprintf(text + used, left, "position.units_per_rev of %.4f or more at a 'counts_per_rev' of %.6g",
                  rounded_up(choice.counts_per_rev / most), choice.counts_per_rev);
  throw InputError(where + ": " + text);
}

}  // namespace lf::config
