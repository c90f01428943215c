#include "hal/vehicle/doctor_command.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "hal/config/drive_kind.hpp"
#include "hal/config/homing_file.hpp"
#include "hal/vehicle/bus_doctor.hpp"
#include "hal/vehicle/daemon.hpp"
#include "hal/vehicle/doctor/examination.hpp"
#include "hal/vehicle/instance_lock.hpp"
#include "hal/vehicle/tick_clock.hpp"
#include "shared/input_error.hpp"

namespace lf::hal {

namespace {

constexpr int done = 0, failed = 1, bad_input = 2, environment = 3;

using doctor::Examination;
using doctor::Examinations;
using doctor::Grade;

ConfiguredDrives drives_of(const VehicleConfig& vehicle) {
  ConfiguredDrives drives;
  const auto folder = std::filesystem::path(vehicle.machine.file).parent_path();
  for (std::size_t i = 0; i < vehicle.machine.joints.size(); ++i) {
    const config::JointDriveChoice drive = config::drive_of(vehicle.machine.drives, i);
    drives[static_cast<std::uint8_t>(drive.node)] = {vehicle.machine.joints[i], config::find_drive_kind(drive.profile, folder)};
  }
  return drives;
}

std::vector<config::DriveKind> shipped_kinds() {
  std::vector<config::DriveKind> kinds;
  for (const std::string& name : config::shipped_drive_kinds()) kinds.push_back(config::find_drive_kind(name, ""));
  return kinds;
}

// Refused while another program is master of the bus.
std::vector<FoundNode> read_bus(const VehicleConfig& vehicle, const std::vector<config::DriveKind>& kinds,
                                const ConfiguredDrives& configured) {
  const std::string& interface = vehicle.interface;
  // A daemon that waits for its first order sends nothing that could be heard.
  if (const auto held = locked_by_another(vehicle.lock_folder, interface)) throw EnvironmentLacks(*held + "; stop it first");
  SocketCan::Config config;
  config.interface = interface;
  std::vector<std::uint8_t> nodes{static_cast<std::uint8_t>(vehicle.machine.drives.output_node)};
  for (const auto& [node, drive] : configured) nodes.push_back(node);
  config.filters = core_filters(nodes);
  for (std::uint32_t node = 1; node <= 126; ++node) config.filters.push_back(CanFilter::exactly(0x580 + node));
  SocketCan can(config);
  if (const PortStatus error = can.open(); error != port_ok) throw EnvironmentLacks(SocketCan::explain(error, interface));
  // Questions on a bus that has a master would stop its arm: a core takes them for another master's.
  if (const auto master = hear_another_master(can, listen_for_a_master)) throw EnvironmentLacks(interface + ": " + *master);
  TickClock clock(Duration::from_ms(1));
  clock.start();
  std::vector<config::DriveKind> checked = kinds;
  for (const auto& [node, drive] : configured) checked.push_back(drive.kind);
  BusDoctor bus(1, 126, checked);
  std::vector<CanFrame> out;
  while (!bus.done()) {
    const Time now = clock.wait();
    for (ReceivedFrame received; can.receive(received) == port_ok;) bus.on_frame(received.frame, now);
    out.clear();
    bus.step(now, out);
    (void)can.send(out);
  }
  return bus.nodes();
}

struct Report {
  std::vector<std::string> problems;  // of the configuration
  Examinations machine;
  std::optional<std::vector<FoundNode>> nodes;
  std::vector<config::DriveKind> kinds;
  ConfiguredDrives configured;

  nlohmann::ordered_json bus() const { return nodes ? doctor_json(*nodes, kinds, configured) : nlohmann::ordered_json(nullptr); }
  int status() const {
    if (!problems.empty()) return bad_input;
    if (std::any_of(machine.begin(), machine.end(), [](const Examination& one) { return one.grade == Grade::bad; })) return environment;
    return nodes && !bus()["agrees"].get<bool>() ? failed : done;
  }
};

void tell_json(const DoctorRequest& request, const Report& report) {
  using Json = nlohmann::ordered_json;
  Json problems = Json::array(), findings = Json::array();
  for (const std::string& problem : report.problems) problems.push_back(problem);
  for (const Examination& one : report.machine) {
    const bool good = one.grade == Grade::good;
    findings.push_back({{"subject", one.subject},
                        {"key", one.key.empty() ? Json(nullptr) : Json(one.key)},
                        {"grade", one.grade == Grade::bad ? "bad" : doctor::name(one.grade)},
                        {"found", one.found},
                        {"remedy", good ? Json(nullptr) : Json(one.remedy)}});
  }
  const Json document{{"config", request.config.empty() ? Json(nullptr) : Json(request.config)},
                      {"ok", report.status() == done},
                      {"problems", problems},
                      {"findings", findings},
                      {"bus", report.bus()},
                      {"exit_status", report.status()}};
  std::printf("%s\n", document.dump(1, ' ', false, Json::error_handler_t::replace).c_str());
}

void tell(const Report& report) {
  for (const std::string& problem : report.problems) std::printf("%s\n", problem.c_str());
  std::fputs(doctor::text_of(report.machine).c_str(), stdout);
  if (report.nodes) std::fputs(doctor_text(*report.nodes, report.kinds, report.configured).c_str(), stdout);
}

}  // namespace

int run_doctor(const DoctorRequest& request) {
  if (request.config.empty() && (request.interface.empty() || request.machine_only))
    throw InputError("doctor needs --config FILE, or --interface for the bus alone");
  Report report;
  VehicleConfig vehicle;
  if (!request.config.empty()) vehicle = load_vehicle_config(request.config, report.problems);
  if (!request.interface.empty()) vehicle.interface = request.interface;
  const bool with_machine = !request.config.empty() && !request.bus_only;
  doctor::Machine machine;
  machine.daemon_runs = locked_by_another(vehicle.lock_folder, vehicle.interface).has_value();
  if (with_machine) {
    report.machine = doctor::examine(vehicle, machine);
  }
  if (!request.machine_only && report.problems.empty()) {
    report.kinds = shipped_kinds();
    if (!request.config.empty()) report.configured = drives_of(vehicle);
    try {
      report.nodes = read_bus(vehicle, report.kinds, report.configured);
    } catch (const EnvironmentLacks& lacks) {
      if (!with_machine) throw;
      // A daemon at work is in order. Anything else, such as a foreign master, would keep the daemon from its start, too.
      const Grade grade = machine.daemon_runs ? Grade::note : Grade::bad;
      report.machine.push_back({"drives", "", grade, std::string("not read: ") + lacks.what(), "the same again, once that is so"});
    }
  }
  if (request.json) {
    tell_json(request, report);
  } else {
    tell(report);
  }
  return report.status();
}

}  // namespace lf::hal
