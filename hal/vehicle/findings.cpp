#include "hal/vehicle/findings.hpp"

#include <algorithm>

#include "hal/vehicle/zero_moved.hpp"

namespace lf::hal {

namespace {

double moved_rad(const arm::Arm& arm, const Commissioned& commissioned, const config::HomingOffsets& offsets, std::size_t joint) {
  if (!offsets.has_earlier_zero(joint)) return commissioned.moved_rad[joint];
  const double off_counts = static_cast<double>(commissioned.zero_counts[joint]) - offsets.zero_counts[joint];
  const double off_rad = zero_moved_rad(arm.joint(joint), commissioned.place_rad[joint], off_counts);
  return std::max(commissioned.moved_rad[joint], off_rad > told_move_rad ? off_rad : 0);
}

// Why a joint that was found stays without power for its friction, in words.
std::optional<std::string> friction_doubt(const Commissioned& commissioned, const PerJoint<Motor>& motors,
                                          const config::HomingOffsets& offsets, std::size_t joint) {
  if (commissioned.friction_found[joint])
    return config::friction_problem(offsets.names[joint], commissioned.friction[joint], motors[joint]);
  const bool doubtful =
      offsets.friction_doubtful[joint] ||
      (offsets.friction_known[joint] && config::friction_problem(offsets.names[joint], offsets.friction[joint], motors[joint]).has_value());
  if (!doubtful) return std::nullopt;
  return "the " + offsets.names[joint] +
         "'s friction was doubtful before, and no friction was measured now. Commission it away from its stop, without --here";
}

}  // namespace

Json friction_json(const config::HomingOffsets& offsets) {
  Json all = Json::object();
  for (std::size_t i = 0; i < offsets.names.size(); ++i) {
    const config::JointFriction& friction = offsets.friction[i];
    if (offsets.friction_known[i])
      all[offsets.names[i]] = {
          {"coulomb_mnm", friction.coulomb_mnm}, {"viscous_mnm_s", friction.viscous_mnm_s}, {"rms_mnm", friction.rms_mnm}};
  }
  return all;
}

TakenOver take_over(const arm::Arm& arm, const Commissioned& commissioned, const PerJoint<Motor>& motors, config::HomingOffsets& offsets) {
  TakenOver taken;
  for (std::size_t i = 0; i < offsets.names.size(); ++i) {
    if (!commissioned.found[i]) continue;
    taken.moved_rad[i] = moved_rad(arm, commissioned, offsets, i);
    if (const std::optional<std::string> why = friction_doubt(commissioned, motors, offsets, i)) {
      taken.left_out.push_back(*why);
      // What was known of it before may be as wrong.
      offsets.doubt_friction(i);
      offsets.found[i] = commissioned.how;
      continue;
    }
    offsets.zero_counts[i] = commissioned.zero_counts[i];
    offsets.known[i] = true;
    offsets.zero_doubtful[i] = offsets.friction_doubtful[i] = false;
    offsets.found[i] = commissioned.how;
    if (!commissioned.friction_found[i]) continue;
    offsets.friction[i] = commissioned.friction[i];
    offsets.friction_known[i] = true;
  }
  return taken;
}

bool leaves_doubt(const Commissioning& ended, const PerJoint<Motor>& motors, const JointNames& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (ended.moved_rad()[i] > 0) return true;
    if (ended.friction_found()[i] && config::friction_problem(names[i], ended.friction()[i], motors[i])) return true;
  }
  return false;
}

std::string found_elsewhere(const TakenOver& taken, const JointNames& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (taken.moved_rad[i] > 0) return names[i] + ": its zero was found elsewhere than the homing file has it";
  }
  return "";
}

void tell_moved(TakenOver& taken, const JointNames& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (taken.moved_rad[i] > 0) taken.left_out.push_back("the " + names[i] + "'s zero has moved, and the new one was not written");
  }
}

JointSet doubted_joints(const Commissioned& commissioned, const TakenOver& taken, const config::HomingOffsets& offsets) {
  JointSet doubted{};
  for (std::size_t i = 0; i < doubted.size(); ++i)
    doubted[i] = commissioned.found[i] && (taken.moved_rad[i] > 0 || offsets.friction_doubtful[i]);
  return doubted;
}

JointSet with_a_zero(const JointSet& lost, const config::HomingOffsets& offsets) {
  JointSet both{};
  for (std::size_t i = 0; i < both.size(); ++i) both[i] = lost[i] && offsets.has_earlier_zero(i);
  return both;
}

std::string ending(const std::string& failed, const std::string& unwritten_for, const JointSet& doubted, const JointSet& gone,
                   const Marks& marks) {
  if (!unwritten_for.empty())
    return (failed.empty() ? "" : failed + ". ") + "Nothing was written: " + unwritten_for +
           ". In the homing file these joints' zeros are still marked doubtful, so that a daemon started anew gives them no power: " +
           names_of(marks.joints, marks.before.names);
  if (failed.empty()) return "";
  if (!any(doubted) && !any(gone)) return "nothing was written: " + failed;
  std::string text = failed;
  if (any(doubted)) text += ". In the homing file the zeros of these joints are doubtful now: " + names_of(doubted, marks.before.names);
  if (any(gone))
    text += ". These are no longer in the homing file, since their drives have lost their positions: " + names_of(gone, marks.before.names);
  return text + ". Nothing else was written";
}

std::vector<std::string> cut_off(const config::HomingOffsets& offsets, const JointSet& found, const ControllerConfig& core) {
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < core.network.drives.size(); ++i) {
    if (!found[i] && core.network.drives[i].zero_known && offsets.friction_doubtful[i] && !offsets.friction_known[i])
      sentences.push_back("the homing file has the " + offsets.names[i] + "'s friction as doubtful");
  }
  return sentences;
}

void deny_power(const JointSet& denied, ControllerConfig& core, config::HomingOffsets& offsets) {
  for (std::size_t i = 0; i < core.network.drives.size(); ++i) {
    bool& known = core.network.drives[i].zero_known;
    known = known && !denied[i];
    offsets.known[i] = known;
  }
}

void use_zeros(const config::HomingOffsets& offsets, const JointSet& found, const JointSet& still_lost, ControllerConfig& core) {
  for (std::size_t i = 0; i < core.network.drives.size(); ++i) {
    canopen::DriveSetup& drive = core.network.drives[i];
    if (found[i]) {
      drive.encoder_zero_counts = offsets.zero_counts[i];
      drive.zero_known = offsets.known[i];
      config::set_friction(offsets, i, core.transmissions[i].friction);
    }
    drive.zero_known = drive.zero_known && !still_lost[i] && !offsets.friction_doubtful[i];
  }
}

}  // namespace lf::hal
