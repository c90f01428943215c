// Folders and files: the log's, with the space it wants; the lock's; the operator's socket's; the zeros', which a commissioning writes.
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "hal/vehicle/doctor/examination.hpp"
#include "hal/vehicle/instance_lock.hpp"

namespace lf::hal::doctor {

namespace {

namespace fs = std::filesystem;

constexpr double packed_share = 0.15;  // of a can0.log that is compressed

// The folder itself, or the nearest that is there and in which it would be made.
fs::path standing_folder(const fs::path& folder) {
  std::error_code ignored;
  fs::path at = fs::absolute(folder, ignored);
  while (!fs::exists(at, ignored) && at.has_relative_path()) at = at.parent_path();
  return at;
}

// /proc and its like: nothing is made there.
bool is_pseudo(const fs::path& folder) {
  struct statvfs volume {};
  return statvfs(folder.c_str(), &volume) == 0 && volume.f_blocks == 0;
}

void examine_folder(const char* subject, const char* key, const std::string& folder, Grade grade, Examinations& found) {
  if (folder.empty()) return;  // refused with the file's own problems
  const fs::path at = standing_folder(folder);
  std::error_code ignored;
  if (!fs::is_directory(at, ignored)) {
    found.push_back({subject, key, grade, at.string() + " is no folder", "name another place"});
  } else if (is_pseudo(at) || access(at.c_str(), W_OK | X_OK) != 0) {
    found.push_back(
        {subject, key, grade, folder + ": nothing can be written in " + at.string(), "give this user the right, or name another place"});
  } else {
    found.push_back({subject, key, Grade::good, folder + (at == fs::absolute(folder, ignored) ? " can be written" : " can be made"), ""});
  }
}

void examine_log_space(const VehicleConfig& config, Examinations& found) {
  if (config.log_folder.empty()) return;
  struct statvfs volume {};
  if (statvfs(standing_folder(config.log_folder).c_str(), &volume) != 0 || volume.f_blocks == 0) return;
  const double free_mb = 1e-6 * static_cast<double>(volume.f_bavail) * static_cast<double>(volume.f_frsize);
  const double share = config.log_pack ? packed_share : 1;
  const double needed_mb = static_cast<double>(config.log_file_mb) * (2 + config.log_keep * share);
  const bool enough = free_mb >= needed_mb;
  found.push_back({"log's space", "log.keep", enough ? Grade::good : Grade::bad,
                   "the logs take up to " + std::to_string(static_cast<long>(needed_mb)) + " MB, and " +
                       std::to_string(static_cast<long>(free_mb)) + " MB are free in " + config.log_folder,
                   enough ? "" : "keep fewer (`log.keep`), or smaller ones (`log.file_mb`)"});
}

// The log's and the socket's folders are made; this one is the system's, and a lock elsewhere than the other masters' would keep none out.
void examine_lock(const VehicleConfig& config, Examinations& found) {
  constexpr const char* subject = "lock";
  constexpr const char* key = "lock_folder";
  if (config.lock_folder.empty()) return;
  std::error_code ignored;
  if (!fs::exists(config.lock_folder, ignored)) {
    const bool usual = config.lock_folder == VehicleConfig().lock_folder;
    const bool makeable = !is_pseudo(standing_folder(config.lock_folder));
    const std::string make = (usual ? "the service makes it; for a start by hand " : "") + ("`mkdir " + config.lock_folder + "`, or ");
    found.push_back({subject, key, Grade::bad, config.lock_folder + " is not there", (makeable ? make : "") + "name another place"});
    return;
  }
  const std::string file = InstanceLock::file_of(config.lock_folder, config.interface);
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) {
    found.push_back({subject, key, Grade::bad, file + " is no file", "move it away"});
    return;
  }
  if (access(file.c_str(), F_OK) == 0 && access(file.c_str(), R_OK | W_OK) != 0) {
    found.push_back(
        {subject, key, Grade::bad, file + ": " + std::strerror(errno), "`rm " + file + "`, as its owner: an earlier daemon left it"});
    return;
  }
  if (const auto held = locked_by_another(config.lock_folder, config.interface)) {
    found.push_back({subject, key, Grade::good, *held, ""});
    return;
  }
  examine_folder(subject, key, config.lock_folder, Grade::bad, found);
}

void examine_socket(const VehicleConfig& config, Examinations& found) {
  struct stat status {};
  if (lstat(config.operator_socket.c_str(), &status) == 0 && !S_ISSOCK(status.st_mode)) {
    found.push_back({"operator's socket", "operator.socket", Grade::bad, config.operator_socket + " is something else than a socket",
                     "move it away, or name another place"});
    return;
  }
  examine_folder("operator's socket", "operator.socket", fs::path(config.operator_socket).parent_path().string(), Grade::bad, found);
}

}  // namespace

void examine_places(const VehicleConfig& config, const Machine&, Examinations& found) {
  examine_folder("log", "log.folder", config.log_folder, Grade::bad, found);
  examine_log_space(config, found);
  examine_lock(config, found);
  examine_socket(config, found);
  // The daemon runs without it: a commissioning writes beside the file, and renames.
  if (!config.machine.homing_file.empty())
    examine_folder("zeros' folder", "homing.file", fs::path(config.machine.homing_file).parent_path().string(), Grade::note, found);
}

}  // namespace lf::hal::doctor
