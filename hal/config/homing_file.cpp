#include "hal/config/homing_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <sstream>

#include "hal/config/text_file.hpp"
#include "hal/config/yaml_reader.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

HomingOffsets read_homing_file(const std::string& path, const JointNames& names) {
  const Source source = Source::of_file(path);
  const YAML::Node root = parse_yaml(read_text_file(path), source);
  HomingOffsets offsets;
  offsets.names = names;
  if (root.IsNull()) return offsets;
  if (!root.IsMap()) source.refuse(root.Mark(), "not a file of homing offsets");
  Keys table;
  constexpr double low = std::numeric_limits<std::int32_t>::min() / 2.0, high = std::numeric_limits<std::int32_t>::max() / 2.0;
  constexpr double most_mnm = 1e5;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string& joint = names[i];
    table.push_back(key(joint + ".zero_counts", "counts", low, high, &offsets.zero_counts[i], ""));
    table.push_back(key(joint + ".zero_doubtful", "", 0, 0, &offsets.zero_doubtful[i], ""));
    table.push_back(key(joint + ".found", "", 0, 0, &offsets.found[i], ""));
    table.push_back(key(joint + ".coulomb_mnm", "mN m", 0, most_mnm, &offsets.friction[i].coulomb_mnm, ""));
    table.push_back(key(joint + ".viscous_mnm_s", "mN m s", 0, most_mnm, &offsets.friction[i].viscous_mnm_s, ""));
    table.push_back(key(joint + ".friction_doubtful", "", 0, 0, &offsets.friction_doubtful[i], ""));
    table.push_back(key(joint + ".friction_rms_mnm", "mN m", 0, most_mnm, &offsets.friction[i].rms_mnm, ""));
  }
  for (const auto& joint : root) {
    if (joint.first.IsScalar() && !names.find(joint.first.Scalar()) && names != JointNames())
      source.refuse(joint.first.Mark(),
                    "'" + joint.first.Scalar() + "': these zeros are of another arm; this one's joints are " + names.listed(names.size()));
  }
  read_map(root, "", "", table, source);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const YAML::Node joint = root[names[i]];
    if (!joint || (offsets.friction_doubtful[i] && !offsets.zero_doubtful[i])) continue;
    if (!joint["zero_counts"]) source.refuse(joint.Mark(), "'" + names[i] + ".zero_counts' is missing: commission this joint");
    if (offsets.friction_doubtful[i]) continue;
    offsets.known[i] = !offsets.zero_doubtful[i];
    offsets.friction_known[i] = joint["coulomb_mnm"] && joint["viscous_mnm_s"];
    if (!offsets.friction_known[i] && (joint["coulomb_mnm"] || joint["viscous_mnm_s"]))
      source.refuse(joint.Mark(), "'" + names[i] + "' has one of coulomb_mnm and viscous_mnm_s: a friction needs both");
  }
  return offsets;
}

std::optional<std::string> friction_problem(const std::string& joint, const JointFriction& found, const Motor& motor) {
  // The simulator's friction goes up to twice (viscous: ten times) the description's. Commissioning finds the roll's a quarter too large, the others to 2 %.
  constexpr double most_coulomb = 3, most_viscous = 10, fit_error = 1.1;
  const auto problem = [&](const char* key, double value_mnm, double described_nm, double times,
                           double rated) -> std::optional<std::string> {
    const double most_mnm = 1e3 * (described_nm > 0 ? times * fit_error * described_nm : rated);
    if (value_mnm >= 0 && value_mnm <= most_mnm) return std::nullopt;  // what is not a number is neither
    char text[320];
    std::snprintf(
        text, sizeof text,
        "'%s.%s' is %.4g: with this motor it is 0 to %.4g (the arm's description has %.4g). See whether something rubs, and commission the "
        "joint again; or correct the friction in the arm's description",
        joint.c_str(), key, value_mnm, most_mnm, 1e3 * described_nm);
    return text;
  };
  // A description without friction leaves the motor's rating as the bound: no motor turns against more.
  if (auto coulomb = problem("coulomb_mnm", found.coulomb_mnm, motor.coulomb_nm, most_coulomb, motor.rated_torque_nm)) return coulomb;
  return problem("viscous_mnm_s", found.viscous_mnm_s, motor.viscous_nm_s, most_viscous, motor.rated_torque_nm / motor.top_speed_rad_s);
}

std::vector<std::string> leave_out_doubtful(HomingOffsets& offsets, const PerJoint<Motor>& motors) {
  std::vector<std::string> left_out;
  for (std::size_t i = 0; i < offsets.names.size(); ++i) {
    if (!offsets.friction_known[i]) continue;
    const std::optional<std::string> problem = friction_problem(offsets.names[i], offsets.friction[i], motors[i]);
    if (!problem) continue;
    left_out.push_back(*problem);
    offsets.doubt_friction(i);
  }
  return left_out;
}

void set_friction(const HomingOffsets& offsets, std::size_t joint, arm::Friction& friction) {
  if (!offsets.friction_known[joint]) return;
  constexpr double other_day = 0.05, most = 0.5;
  const JointFriction& found = offsets.friction[joint];
  friction.coulomb_nm = 1e-3 * found.coulomb_mnm;
  friction.viscous_nm_s = 1e-3 * found.viscous_mnm_s;
  friction.doubt = found.coulomb_mnm > 0 ? std::min(most, other_day + found.rms_mnm / found.coulomb_mnm) : most;
}

namespace {

// 0 or errno. On the disk when it returns.
int write_through(const std::string& path, const std::string& text) {
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) return errno;
  errno = 0;
  const bool written = write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && fsync(fd) == 0;
  int error = written ? 0 : errno != 0 ? errno : ENOSPC;  // a short write leaves no errno
  if (close(fd) != 0 && error == 0) error = errno;
  return error;
}

// The new name is on the disk when it returns.
int rename_through(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) return errno;
  const std::string folder = std::filesystem::absolute(to).parent_path().string();
  const int fd = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return errno;
  const int error = fsync(fd) == 0 ? 0 : errno;
  close(fd);
  return error;
}

std::string joint_line(const HomingOffsets& offsets, std::size_t joint) {
  std::ostringstream line;
  line << offsets.names[joint] << ": {";
  if (offsets.zero_doubtful[joint] || !offsets.friction_doubtful[joint]) line << "zero_counts: " << offsets.zero_counts[joint] << ", ";
  if (offsets.zero_doubtful[joint]) line << "zero_doubtful: true, ";
  if (offsets.friction_doubtful[joint]) line << "friction_doubtful: true, ";
  if (offsets.friction_known[joint] && !offsets.friction_doubtful[joint]) {
    const JointFriction& friction = offsets.friction[joint];
    line << "coulomb_mnm: " << friction.coulomb_mnm << ", viscous_mnm_s: " << friction.viscous_mnm_s
         << ", friction_rms_mnm: " << friction.rms_mnm << ", ";
  }
  line << "found: \"" << offsets.found[joint] << "\"}\n";
  return line.str();
}

}  // namespace

bool HomingOffsets::has_earlier_zero(std::size_t joint) const { return known[joint] || zero_doubtful[joint]; }

void HomingOffsets::doubt_zero(std::size_t joint) {
  zero_doubtful[joint] = has_earlier_zero(joint);
  known[joint] = false;
}

void HomingOffsets::forget_zero(std::size_t joint) { known[joint] = zero_doubtful[joint] = false; }

void HomingOffsets::take_joint(const HomingOffsets& from, std::size_t joint) {
  zero_counts[joint] = from.zero_counts[joint];
  known[joint] = from.known[joint];
  zero_doubtful[joint] = from.zero_doubtful[joint];
  friction_known[joint] = from.friction_known[joint];
  friction_doubtful[joint] = from.friction_doubtful[joint];
  friction[joint] = from.friction[joint];
  found[joint] = from.found[joint];
}

void HomingOffsets::doubt_friction(std::size_t joint) {
  doubt_zero(joint);
  friction_known[joint] = false;
  friction_doubtful[joint] = true;
}

void write_homing_file(const std::string& path, const HomingOffsets& offsets) {
  std::ostringstream out;
  out << "# Written by `lanternfishd commission`: what each drive's absolute encoder counts where the arm's own count is 0,\n"
         "# and the friction of its motor and gear, in mN m at the motor's shaft, with what the fit left of it.\n";
  for (std::size_t i = 0; i < offsets.names.size(); ++i) {
    if (offsets.known[i] || offsets.zero_doubtful[i] || offsets.friction_doubtful[i]) out << joint_line(offsets, i);
  }
  const std::string partial = path + ".partial";
  int error = write_through(partial, out.str());
  if (error == 0) error = rename_through(partial, path);
  if (error != 0) throw InputError(path + ": cannot be written: " + std::strerror(error));
}

}  // namespace lf::config
