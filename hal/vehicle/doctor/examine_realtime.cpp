// Real time: what this process is permitted (SCHED_FIFO, locked memory), what the kernel takes away again (throttling), and how soon it wakes a thread.
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>

#include "hal/vehicle/doctor/examination.hpp"

namespace lf::hal::doctor {

namespace {

constexpr int cap_ipc_lock = 14, cap_sys_nice = 23;  // linux/capability.h
// The control thread computes for 50 us of its 4 ms; with the kernel's part of it, and threads of the same priority, a tenth is enough.
constexpr double least_share = 0.1;

bool has_capability(const Machine& machine, int capability) {
  std::ifstream status(machine.proc / "self/status");
  for (std::string line; std::getline(status, line);) {
    if (!line.starts_with("CapEff:")) continue;
    const std::size_t digits = line.find_first_not_of(" \t", 7);
    std::uint64_t mask = 0;
    if (digits == std::string::npos) return false;
    std::from_chars(line.data() + digits, line.data() + line.size(), mask, 16);
    return (mask >> capability & 1U) != 0;
  }
  return false;
}

// The soft limit in its column: "Max realtime priority     0                    0"; "unlimited" is the word.
std::string soft_limit(const Machine& machine, const std::string& name) {
  std::ifstream limits(machine.proc / "self/limits");
  for (std::string line; std::getline(limits, line);) {
    if (!line.starts_with(name)) continue;
    std::istringstream rest(line.substr(name.size()));
    std::string soft;
    rest >> soft;
    return soft;
  }
  return "";
}

std::optional<long long> number_in(const std::string& text) {
  long long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end != text.data() ? std::optional(value) : std::nullopt;
}

void examine_priority(const VehicleConfig& config, const Machine& machine, Examinations& found) {
  constexpr const char* key = "realtime.priority";
  const int wanted = config.realtime.priority;
  if (wanted == 0)
    return found.push_back(
        {"priority", key, Grade::note, "SCHED_FIFO is not asked for: other programs delay the control thread", "`realtime.priority: 80`"});
  const std::string limit = soft_limit(machine, "Max realtime priority");
  const bool may = has_capability(machine, cap_sys_nice) || limit == "unlimited" || number_in(limit).value_or(0) >= wanted;
  found.push_back(
      {"priority", key, may ? Grade::good : Grade::bad,
       may ? "SCHED_FIFO " + std::to_string(wanted) + " is permitted"
           : "this user may not have priority " + std::to_string(wanted) + " (its limit is " + (limit.empty() ? "unknown" : limit) + ")",
       may ? "" : "run it as the service does, or set LimitRTPRIO"});
}

void examine_memory(const VehicleConfig& config, const Machine& machine, Examinations& found) {
  constexpr const char* key = "realtime.lock_memory";
  if (!config.realtime.lock_memory)
    return found.push_back(
        {"locked memory", key, Grade::note, "it is not asked for: a page that was put away comes late", "`realtime.lock_memory: true`"});
  const std::string limit = soft_limit(machine, "Max locked memory");
  const bool may = has_capability(machine, cap_ipc_lock) || limit == "unlimited";
  found.push_back({"locked memory", key, may ? Grade::good : Grade::bad,
                   may ? "all of it is permitted"
                       : "this user may not lock all memory (its limit is " + (limit.empty() ? "unknown" : limit + " bytes") + ")",
                   may ? "" : "run it as the service does, or set LimitMEMLOCK=infinity"});
}

void examine_throttle(const VehicleConfig& config, const Machine& machine, Examinations& found) {
  if (config.realtime.priority == 0) return;
  const auto runtime = number_in(first_line(machine.proc / "sys/kernel/sched_rt_runtime_us"));
  const auto period = number_in(first_line(machine.proc / "sys/kernel/sched_rt_period_us"));
  if (!runtime || !period || *period <= 0) return;
  if (*runtime < 0) return found.push_back({"throttling", "", Grade::good, "off: SCHED_FIFO threads may run for ever", ""});
  const double share = static_cast<double>(*runtime) / static_cast<double>(*period);
  const std::string text = std::to_string(*runtime) + " us of every " + std::to_string(*period) + " us are for real-time threads";
  if (share >= least_share) return found.push_back({"throttling", "", Grade::good, text, ""});
  found.push_back(
      {"throttling", "", Grade::bad, text + ": then the control thread stands still", "`sysctl kernel.sched_rt_runtime_us=950000`"});
}

bool says(const std::string& text, const char* word) { return (" " + text + " ").find(std::string(" ") + word + " ") != std::string::npos; }

void examine_kernel(const Machine& machine, Examinations& found) {
  const std::string version = first_line(machine.proc / "version"), command = first_line(machine.proc / "cmdline");
  if (version.empty()) return;
  const bool real_time = first_line(machine.sys / "kernel/realtime") == "1" || says(version, "PREEMPT_RT");
  if (real_time) return found.push_back({"kernel", "", Grade::good, "a real-time kernel (PREEMPT_RT)", ""});
  if (says(command, "preempt=full") || says(version, "PREEMPT"))
    return found.push_back({"kernel", "", Grade::good, "preempted whenever the control thread is due", ""});
  found.push_back({"kernel", "", Grade::note, "it finishes another program's work before it wakes the control thread: up to some ms late",
                   "`preempt=full` on its command line (GRUB_CMDLINE_LINUX), or linux-image-rt-amd64"});
}

// "0-3,6": whether `cpu` is in it.
bool in_list(const std::string& list, int cpu) {
  std::istringstream parts(list);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-');
    const auto first = number_in(part), last = dash == std::string::npos ? first : number_in(part.substr(dash + 1));
    if (first && last && cpu >= *first && cpu <= *last) return true;
  }
  return false;
}

void examine_processor(const char* subject, const char* key, int cpu, bool alone, const Machine& machine, Examinations& found) {
  if (cpu < 0) return;
  const std::filesystem::path folder = machine.sys / "devices/system/cpu";
  const std::string online = first_line(folder / "online"), number = std::to_string(cpu);
  if (online.empty()) return;
  if (!in_list(online, cpu)) {
    found.push_back({subject, key, Grade::bad, "there is no processor " + number, "this machine has " + online});
  } else if (alone && !in_list(first_line(folder / "isolated"), cpu)) {
    found.push_back({subject, key, Grade::note, "processor " + number + " is used by other programs, too",
                     "`isolcpus=" + number + "` on the kernel's command line, where the machine has processors to spare"});
  } else {
    found.push_back({subject, key, Grade::good, "processor " + number + (alone ? ", isolated from other programs" : " is there"), ""});
  }
}

}  // namespace

void examine_realtime(const VehicleConfig& config, const Machine& machine, Examinations& found) {
  examine_priority(config, machine, found);
  examine_memory(config, machine, found);
  examine_throttle(config, machine, found);
  examine_kernel(machine, found);
  examine_processor("processor", "realtime.cpu", config.realtime.cpu, true, machine, found);
  examine_processor("vision's processor", "realtime.vision_cpu", config.vision_cpu, false, machine, found);
}

}  // namespace lf::hal::doctor
