#include "hal/vehicle/machine_check.hpp"

#include <grp.h>
#include <linux/can.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <pwd.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "hal/config/homing_file.hpp"

namespace lf::hal {

namespace {

namespace fs = std::filesystem;
using Findings = std::vector<Finding>;

// Two ticks' frames; more of them delay a quick stop.
constexpr int longest_queue = 64;
constexpr double packed_share = 0.15;  // of a can0.log that is compressed

void check_interface(const VehicleConfig& config, Findings& found) {
  const auto add = [&](const std::string& problem, const std::string& remedy) { found.push_back({"can.interface", problem, remedy}); };
  const std::string& name = config.interface;
  ifreq request{};
  name.copy(request.ifr_name, sizeof request.ifr_name - 1);
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const auto ask = [&](unsigned long what) { return ioctl(fd, what, &request) == 0; };
  if (const int can = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW); can >= 0) {
    close(can);
  } else {
    found.push_back({"can", std::string("this kernel gives no CAN socket: ") + std::strerror(errno),
                     "`modprobe can_raw`, or a kernel with CONFIG_CAN"});
  }
  if (if_nametoindex(name.c_str()) == 0) {
    add("there is no interface " + name, "`ip link` lists them");
  } else if (!ask(SIOCGIFHWADDR) || request.ifr_hwaddr.sa_family != ARPHRD_CAN) {
    add(name + " is no CAN interface", "`ip -details link show type can` lists those");
  } else {
    if (!ask(SIOCGIFFLAGS) || (request.ifr_flags & IFF_UP) == 0)
      add(name + " is down", "`ip link set " + name + " up`, a real one with `type can bitrate 1000000 restart-ms 0`");
    const bool real = fs::exists("/sys/class/net/" + name + "/device");
    if (real && ask(SIOCGIFTXQLEN) && request.ifr_qlen > longest_queue)
      add(name + " queues " + std::to_string(request.ifr_qlen) + " frames: old set points reach the drives before a quick stop",
          "`ip link set " + name + " txqueuelen 32`");
  }
  close(fd);
}

void check_camera(const VehicleConfig& config, Findings& found) {
  if (config.camera_source == "device") {
    V4l2Camera camera(config.v4l2());
    if (const PortStatus error = camera.open(); error != port_ok)
      found.push_back({"camera.device", V4l2Camera::explain(error, config.v4l2()), "without it `start` is refused"});
  }
  if (config.camera_source == "ring" && access(config.ring.c_str(), R_OK) != 0)
    found.push_back({"camera.ring", config.ring + ": " + std::strerror(errno), "start what writes it, such as `lanternfish serve`"});
}

void check_users(const std::vector<std::string>& names, const char* key, Findings& found) {
  for (const std::string& name : names) {
    const bool group = name.starts_with("@");
    const bool there = group ? getgrnam(name.c_str() + 1) != nullptr : getpwnam(name.c_str()) != nullptr;
    if (!there)
      found.push_back(
          {key, std::string("there is no ") + (group ? "group " : "user ") + name, "`getent passwd` and `getent group` list them"});
  }
}

// The folder itself, or the nearest that is there and in which it would be made.
fs::path standing_folder(const fs::path& folder) {
  fs::path at = fs::absolute(folder);
  std::error_code ignored;
  while (!fs::exists(at, ignored) && at.has_relative_path()) at = at.parent_path();
  return at;
}

void check_folder(const std::string& folder, const char* key, Findings& found) {
  const fs::path at = standing_folder(folder);
  std::error_code ignored;
  struct statvfs volume {};
  const bool pseudo = statvfs(at.c_str(), &volume) == 0 && volume.f_blocks == 0;  // /proc and its like
  if (!fs::is_directory(at, ignored)) {
    found.push_back({key, at.string() + " is no folder", "name another place"});
  } else if (pseudo || access(at.c_str(), W_OK | X_OK) != 0) {
    found.push_back({key, folder + ": nothing can be written in " + at.string(), "give this user the right, or name another place"});
  }
}

// The log's and the socket's folders are made; this one is the system's, and a lock elsewhere than the other masters' would keep none out.
void check_lock_folder(const VehicleConfig& config, Findings& found) {
  std::error_code ignored;
  if (fs::exists(config.lock_folder, ignored)) return check_folder(config.lock_folder, "lock_folder", found);
  found.push_back({"lock_folder", config.lock_folder + " is not there", "`mkdir " + config.lock_folder + "`, or name another place"});
}

void check_log_space(const VehicleConfig& config, Findings& found) {
  struct statvfs volume {};
  if (statvfs(standing_folder(config.log_folder).c_str(), &volume) != 0 || volume.f_blocks == 0) return;
  const double free_mb = 1e-6 * static_cast<double>(volume.f_bavail) * static_cast<double>(volume.f_frsize);
  const double share = config.log_pack ? packed_share : 1;
  const double needed_mb = static_cast<double>(config.log_file_mb) * (2 + config.log_keep * share);
  if (free_mb < needed_mb)
    found.push_back({"log.keep",
                     "the logs take up to " + std::to_string(static_cast<long>(needed_mb)) + " MB, and " +
                         std::to_string(static_cast<long>(free_mb)) + " MB are free in " + config.log_folder,
                     "keep fewer (`log.keep`), or smaller ones (`log.file_mb`)"});
}

void check_realtime(const VehicleConfig& config, Findings& found) {
  if (geteuid() == 0) return;
  rlimit priority{}, memory{};
  getrlimit(RLIMIT_RTPRIO, &priority);
  getrlimit(RLIMIT_MEMLOCK, &memory);
  if (config.realtime.priority > 0 && priority.rlim_cur < static_cast<rlim_t>(config.realtime.priority))
    found.push_back({"realtime.priority", "this user may not have priority " + std::to_string(config.realtime.priority),
                     "run it as the service does, or set LimitRTPRIO"});
  if (config.realtime.lock_memory && memory.rlim_cur != RLIM_INFINITY)
    found.push_back(
        {"realtime.lock_memory", "this user may not lock all memory", "run it as the service does, or set LimitMEMLOCK=infinity"});
}

void check_zeros(const VehicleConfig& config, Findings& found) {
  std::string unknown;
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (!config.core.controller.network.drives[i].may_have_power())
      unknown += (unknown.empty() ? "" : ", ") + std::string(config::joint_name(i));
  }
  if (unknown.empty()) return;
  const bool no_file = config.machine.homing_file.empty();
  found.push_back({"homing.file", (no_file ? "no file is named for the zeros of " : "no zero is known of ") + unknown + ": no power",
                   no_file ? "name an empty one (`touch homing.yaml`), then `lanternfishd commission`, while the daemon runs"
                           : "`lanternfishd commission`, while the daemon runs"});
}

void check_estop(const VehicleConfig& config, Findings& found) {
  if (config.estop_input.empty()) return;
  const char* remedy = "as long as it cannot be read, the chain counts as open";
  std::error_code ignored;
  if (access(config.estop_input.c_str(), R_OK) != 0) {
    found.push_back({"estop.input", config.estop_input + ": " + std::strerror(errno), remedy});
  } else if (fs::is_directory(config.estop_input, ignored)) {
    found.push_back({"estop.input", config.estop_input + " is a folder", remedy});
  } else {
    char first = 0;
    std::ifstream(config.estop_input).get(first);
    if (first != '0' && first != '1') found.push_back({"estop.input", config.estop_input + " reads neither 0 nor 1", remedy});
  }
}

void check_processors(const VehicleConfig& config, Findings& found) {
  const long processors = sysconf(_SC_NPROCESSORS_CONF);
  const auto check = [&](const char* key, int cpu) {
    if (cpu < processors) return;
    found.push_back({key, "there is no processor " + std::to_string(cpu), "this machine has 0 to " + std::to_string(processors - 1)});
  };
  check("realtime.cpu", config.realtime.cpu);
  check("realtime.vision_cpu", config.vision_cpu);
}

}  // namespace

std::vector<Finding> check_machine(const VehicleConfig& config) {
  Findings found;
  check_interface(config, found);
  check_camera(config, found);
  check_users(config.operators, "operator.operators", found);
  check_users(config.engineers, "operator.engineers", found);
  if (!config.operator_group.empty()) check_users({"@" + config.operator_group}, "operator.group", found);
  check_folder(config.log_folder, "log.folder", found);
  check_lock_folder(config, found);
  check_folder(fs::path(config.operator_socket).parent_path().string(), "operator.socket", found);
  check_log_space(config, found);
  check_realtime(config, found);
  check_processors(config, found);
  check_estop(config, found);
  check_zeros(config, found);
  return found;
}

}  // namespace lf::hal
