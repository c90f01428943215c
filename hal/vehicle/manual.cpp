#include "hal/vehicle/manual.hpp"

#include "hal/command_line/man_page.hpp"
#include "hal/vehicle/vehicle_config.hpp"

namespace lf::hal {

namespace {

using command_line::Manual;

Manual program_manual() {
  Manual page{"lanternfishd", "8", "control program of an underwater robot that works on panels", "System administration", {}, {}};
  page.before = {{"DESCRIPTION",
                  "Without a command it runs the control core against CANopen drives on a SocketCAN interface and a camera, in real time, "
                  "as `--config` says. It starts, opens "
                  "the bus, and waits for orders: nothing is powered until `start` or `home`. It refuses to start on a configuration with "
                  "a problem, and lists every one. "
                  "SIGTERM, SIGHUP and Ctrl-C bring the arm to rest, take its power, and write the log.\n\n"
                  "Most commands are orders to the daemon that runs, over its socket: that of `--socket`, of `--config`, or of "
                  "LANTERNFISHD_SOCKET. When an order is possible depends on "
                  "what the arm is doing, and who may give it on the configuration: a refusal says why."}};
  page.after = {{"REAL TIME",
                 "The control thread asks for SCHED_FIFO and locked memory. Where they are not permitted the daemon runs, and says what it "
                 "lost; the unit grants both. "
                 "`lanternfishd --config FILE doctor` looks at all of it beforehand."},
                {"EXIT STATUS",
                 "",
                 {{"0", "Done; of an order: it was taken; of `doctor`: nothing is bad."},
                  {"1",
                   "The job failed or an order was refused; of `doctor`: the bus was read, and a configured drive does not answer or "
                   "differs from its profile."},
                  {"2", "Bad input: the configuration is wrong, or the command line. Another start makes it no better."},
                  {"3", "This machine lacks something, and what to do."}}},
                {"ENVIRONMENT",
                 "",
                 {{"LANTERNFISHD_SOCKET", "The operator's socket, where neither `--socket` nor `--config` says it."},
                  {"LANTERNFISH_SHARE", "Folder of the shipped files, in place of those of the installation."}}},
                {"FILES",
                 "",
                 {{"/etc/lanternfish/vehicle.yaml", "The configuration that the unit uses: `lanternfish-vehicle(5)`."},
                  {"/etc/lanternfish/lanternfish-can.conf",
                   "The arm's CAN interface, which lanternfish-can.service moves into the daemon's network namespace."},
                  {"/run/lanternfishd/operator.sock", "The operator's socket."},
                  {"/var/lib/lanternfish/homing.yaml", "The joints' zeros, which `commission` finds."},
                  {"/var/log/lanternfishd", "can0.log, every frame; log.jsonl, steps, faults and orders."},
                  {"/usr/share/doc/lanternfishd", "installing.md for the first start, operating.md for everything after it."}}},
                {"EXAMPLES",
                 "  lanternfishd --config /etc/lanternfish/vehicle.yaml doctor\n"
                 "  lanternfishd --print-config >vehicle.yaml\n"
                 "  lanternfishd status\n"
                 "  lanternfishd task --turn 45 --press left,centre\n"
                 "  lanternfishd jog elbow -5"},
                {"SEE ALSO", "`lanternfish-vehicle(5)`, `lanternfish(1)`, `systemctl(1)`, `ip-netns(8)`"}};
  return page;
}

Manual vehicle_manual() {
  Manual page{"lanternfish-vehicle", "5", "vehicle.yaml, the configuration of lanternfishd", "File formats", {}, {}};
  page.before = {
      {"DESCRIPTION",
       "A YAML file. What is not named has its default. A key that is not known, and a value out of its range, is refused with file and "
       "line, all of them at once.\n\n"
       "`lanternfishd --config FILE --check` says whether a file is valid and what this machine lacks of it; `doctor` does that at length. "
       "`lanternfishd --print-config` prints a file with every key at its default, and with `--config FILE` at that file's values. "
       "/usr/share/lanternfish/vehicle/vehicle.schema.json has the same keys for editors, and the folder a file for a vehicle and one for "
       "a virtual CAN interface.\n\n"
       "Names of files are relative to the configuration's folder, then to the shipped files in /usr/share/lanternfish."},
      {"EXAMPLE",
       "  can: {interface: can0}\n"
       "  camera: {source: device, device: /dev/video0, exposure_us: 2000}\n"
       "  homing: {file: /var/lib/lanternfish/homing.yaml}\n"
       "  operator: {operators: [\"@lanternfish\"]}\n"
       "  tasks:\n"
       "    - turn_valve: {to_deg: 90}\n"
       "    - press_buttons: {order: [left, centre, right]}"}};
  page.after = {{"SEE ALSO", "`lanternfishd(8)`"}};
  return page;
}

std::string vehicle_page() {
  VehicleConfig vehicle;
  config::Task task;
  return command_line::man_page(vehicle_manual(), keys(vehicle), {{"KEYS OF A TASK", keys(task, {})}});
}

}  // namespace

command_line::ManPages manual_of(const CLI::App& app) {
  return {{"8", [&app] { return command_line::man_page(program_manual(), app); }}, {"5", vehicle_page}};
}

}  // namespace lf::hal
