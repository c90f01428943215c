// What keeps the arm without power: unknown zeros, an emergency-stop input that says nothing.
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "hal/config/homing_file.hpp"
#include "hal/vehicle/doctor/examination.hpp"
#include "hal/vehicle/estop_input.hpp"

namespace lf::hal::doctor {

namespace {

void examine_estop(const VehicleConfig& config, Examinations& found) {
  constexpr const char* key = "estop.input";
  constexpr const char* remedy = "as long as it cannot be read, the chain counts as open";
  if (config.estop_input.empty()) return;
  std::error_code ignored;
  const auto bad = [&](const std::string& problem) {
    found.push_back({"emergency stop", key, Grade::bad, config.estop_input + problem, remedy});
  };
  if (access(config.estop_input.c_str(), R_OK) != 0) return bad(std::string(": ") + std::strerror(errno));
  if (std::filesystem::is_directory(config.estop_input, ignored)) return bad(" is a folder");
  const EstopReading reading = read_estop(config.estop_input);
  if (reading == EstopReading::neither) return bad(" reads neither 0 nor 1");
  const bool closed = reading == EstopReading::closed;
  found.push_back({"emergency stop", key, closed ? Grade::good : Grade::note,
                   closed ? "the chain is whole" : "the chain is open: the arm takes no power", closed ? "" : "close it before `home`"});
}

void examine_zeros(const VehicleConfig& config, Examinations& found) {
  std::string unknown;
  for (std::size_t i = 0; i < config.core.controller.network.drives.size(); ++i) {
    if (!config.core.controller.network.drives[i].may_have_power()) unknown += (unknown.empty() ? "" : ", ") + config.machine.joints[i];
  }
  if (unknown.empty()) return found.push_back({"zeros", "homing.file", Grade::good, "known of all joints", ""});
  const bool no_file = config.machine.homing_file.empty();
  if (no_file && config.homing_named) return;  // that it is not there was told with the file's own problems
  found.push_back({"zeros", "homing.file", Grade::bad,
                   (no_file ? "no file is named for the zeros of " : "no zero is known of ") + unknown + ": no power",
                   no_file ? "name an empty one (`touch homing.yaml`), then `lanternfishd commission`, while the daemon runs"
                           : "`lanternfishd commission`, while the daemon runs"});
}

}  // namespace

void examine_arm(const VehicleConfig& config, const Machine&, Examinations& found) {
  examine_estop(config, found);
  examine_zeros(config, found);
}

}  // namespace lf::hal::doctor
