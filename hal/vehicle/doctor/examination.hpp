// What the doctor of a vehicle's computer looks at, and what it finds.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hal/vehicle/linux_calls.hpp"
#include "hal/vehicle/vehicle_config.hpp"

namespace lf::hal::doctor {

enum class Grade : std::uint8_t {
  good,
  note,  // the daemon runs as it is configured, and less well than it could
  bad,   // it does not, or an order would be refused
};
const char* name(Grade grade);

struct Examination {
  std::string subject;  // "bit rate"
  std::string key;      // of the configuration, that decides it; empty: none does
  Grade grade = Grade::good;
  std::string found;   // one line
  std::string remedy;  // one line; empty when good
};
using Examinations = std::vector<Examination>;

// Where the doctor looks. A test has folders and a kernel of its own.
struct Machine {
  std::filesystem::path proc = "/proc";
  std::filesystem::path sys = "/sys";
  LinuxCalls* calls = &linux_calls();
  bool daemon_runs = false;  // it has the camera then
};

// Each adds what it found of its part. Nothing stays open, and nothing is changed but the camera's exposure and gain, which are set as the
// daemon sets them.
void examine_bus(const VehicleConfig& config, const Machine& machine, Examinations& found);
void examine_camera(const VehicleConfig& config, const Machine& machine, Examinations& found);
void examine_realtime(const VehicleConfig& config, const Machine& machine, Examinations& found);
void examine_clock(const VehicleConfig& config, const Machine& machine, Examinations& found);
void examine_places(const VehicleConfig& config, const Machine& machine, Examinations& found);
void examine_people(const VehicleConfig& config, const Machine& machine, Examinations& found);
void examine_arm(const VehicleConfig& config, const Machine& machine, Examinations& found);

// All of them, in this order.
Examinations examine(const VehicleConfig& config, const Machine& machine = {});

// "interface    good   can0: up": a line each, and "to do: ..." under what is not good.
std::string text_of(const Examinations& found);

// The first line of a file of the kernel's; empty when there is none.
std::string first_line(const std::filesystem::path& file);

}  // namespace lf::hal::doctor
