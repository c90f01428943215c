#include "hal/vehicle/vehicle_config.hpp"

#include <net/if.h>

#include <filesystem>
#include <functional>
#include <limits>
#include <system_error>

#include "hal/config/handle_check.hpp"
#include "hal/config/joined.hpp"
#include "hal/config/key_listing.hpp"
#include "hal/config/key_schema.hpp"
#include "hal/config/key_text.hpp"
#include "hal/config/machine_file.hpp"
#include "hal/config/panel_check.hpp"
#include "hal/config/panel_file.hpp"
#include "hal/config/read_arm.hpp"
#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "hal/config/yaml_reader.hpp"
#include "shared/input_error.hpp"

namespace lf::hal {

namespace {

using config::key;
using config::Keys;

constexpr double largest = std::numeric_limits<std::int32_t>::max();
constexpr std::size_t longest_socket = 107;  // sockaddr_un has 108 bytes, the last of them a zero

void add_bus(Keys& all, VehicleConfig& c) {
  all.push_back(key("can.interface", "", 0, 0, &c.interface, "the CAN interface, real or virtual"));
  all.push_back(
      key("can.transmit_deadline_ms", "ms", 0.5, 100, &c.transmit_deadline_ms, "frames that could not be sent for so long are dropped"));
}

void add_camera_source(Keys& all, VehicleConfig& c) {
  all.push_back(
      key("camera.source", "", 0, 0, &c.camera_source, "a V4L2 device, a shared frame ring, or no camera", {"device", "ring", "none"}));
  all.push_back(key("camera.device", "", 0, 0, &c.device, "the V4L2 device"));
  all.push_back(key("camera.gain", "", 0, largest, &c.gain, "in the driver's units"));
  all.push_back(
      key("camera.stamp_delay_us", "us", -100000, 100000, &c.stamp_delay_us, "from the start of an exposure to its image's time stamp"));
  all.push_back(key("camera.ring", "", 0, 0, &c.ring, "the frame ring: a file, or /dev/mmapper in User Mode Linux"));
  all.push_back(key("camera.ring_bytes", "bytes", 4096, 1e9, &c.ring_bytes, "size of the ring's file"));
  all.push_back(key("camera.ring_offset", "bytes", 0, 1e9, &c.ring_offset, "where in the file the ring begins"));
  all.push_back(key("camera.match_window_us", "us", 100, 20000, &c.match_window_us,
                    "an image belongs to the exposure ordered within this of its start"));
  all.push_back(
      key("camera.image_due_ms", "ms", 10, 2000, &c.image_due_ms, "from the start of an exposure until its image has surely come"));
  all.push_back(key("camera.calibration", "", 0, 0, &c.machine.camera_calibration,
                    "YAML of OpenCV's or ROS's calibration, taken in water, instead of focal_px and distortion"));
  all.push_back(key("camera.always_on", "", 0, 0, &c.machine.camera_always_on, "a frame every camera period throughout, for the record"));
}

void add_machine(Keys& all, VehicleConfig& c) {
  all.push_back(key("machine", "", 0, 0, &c.machine_file,
                    "a file of what the robot is, or a shipped one's name; a key of this file that says another thing is refused; found as "
                    "arm.urdf is; empty: the default machine, but for what the keys say"));
  config::add_panel(all, c.panel_file, c.docked_panel);
  config::add_valve_stops(all, c.valve_stops);
  config::add_camera(all, c.machine.camera);
  config::add_laser(all, c.machine.laser);
  config::add_vehicle(all, c.machine.vehicle);
  all.push_back(key("lamps.lit", "", 0, 0, &c.machine.lamps_lit, "stills are taken with the lamps on"));
  config::add_arm(all, c.machine.arm_urdf, c.machine.park_rad);
  all.push_back(key("safety.limits", "", 0, 0, &c.machine.safety_limits, "the checksummed file of limits; found as arm.urdf is"));
  all.push_back(key("safety.mission_limits", "", 0, 0, &c.machine.mission_limits,
                    "a file of the same form with limits of this mission, none wider; empty: the same"));
  config::add_drives(all, c.machine.drives, c.machine.joints);
  config::add_mission(all, c.machine.mission);
}

void add_running(Keys& all, VehicleConfig& c) {
  all.push_back(key("realtime.priority", "", 0, 98, &c.realtime.priority, "SCHED_FIFO priority of the control thread; 0: not asked for"));
  all.push_back(key("realtime.cpu", "", -1, 1023, &c.realtime.cpu, "the control thread's CPU; -1: any"));
  all.push_back(key("realtime.vision_cpu", "", -1, 1023, &c.vision_cpu, "the vision thread's CPU; -1: any"));
  all.push_back(key("realtime.lock_memory", "", 0, 0, &c.realtime.lock_memory, "nothing is paged out, nothing comes late"));
  all.push_back(key("operator.socket", "", 0, 0, &c.operator_socket, "the operator interface's Unix socket"));
  all.push_back(key("operator.group", "", 0, 0, &c.operator_group, "the group that may open the socket; without it the daemon's own"));
  all.push_back(
      key("operator.everyone", "", 0, 0, &c.operator_everyone, "every user of this machine may open the socket: to see, and to stop"));
  all.push_back(key("operator.operators", "", 0, 0, &c.operators, "users and @groups that may run missions"));
  all.push_back(key("operator.engineers", "", 0, 0, &c.engineers, "users and @groups that may do everything"));
  all.push_back(
      key("estop.input", "", 0, 0, &c.estop_input, "a file that reads 1 while the emergency-stop chain is whole, as a GPIO's value does"));
  all.push_back(key("log.folder", "", 0, 0, &c.log_folder, "can0.log and log.jsonl are written here"));
  all.push_back(key("log.file_mb", "MB", 1, 100'000, &c.log_file_mb, "a file of the log is set aside at this size"));
  all.push_back(key("log.keep", "", 1, 1000, &c.log_keep, "files set aside of each; the oldest beyond them is removed"));
  all.push_back(key("log.pack", "", 0, 0, &c.log_pack, "files set aside are compressed (gzip)"));
  all.push_back(key("lock_folder", "", 0, 0, &c.lock_folder, "where lock files may be"));
  all.push_back(key("homing.file", "", 0, 0, &c.machine.homing_file,
                    "the joints' zeros, which `lanternfishd commission` finds; a joint that is not in it takes no power"));
}

bool page_sized(std::int64_t bytes) { return bytes % static_cast<std::int64_t>(frame_ring_page) == 0; }

// A calibration overrules both. A value that is the default's counts as not given: a file that is printed with its defaults has to be read back.
void check_calibration(const config::Machine& machine, const config::Camera& usual, const std::function<void(const std::string&)>& refuse) {
  if (machine.camera_calibration.empty()) return;
  constexpr const char* remedy = ": the calibration has both focal length and distortion, leave the other key out";
  if (machine.camera.focal_px != usual.focal_px) refuse(std::string("'camera.calibration' stands beside 'camera.focal_px'") + remedy);
  if (machine.camera.distortion != usual.distortion) refuse(std::string("'camera.calibration' stands beside 'camera.distortion'") + remedy);
}

// What no single key can tell.
void check_together(const VehicleConfig& c, const std::string& file, std::vector<std::string>& problems) {
  const auto refuse = [&](const std::string& message) { problems.push_back(file + ": " + message); };
  if (c.interface.empty() || c.interface.size() >= IF_NAMESIZE)
    refuse("'can.interface' takes a name of 1 to 15 letters, not '" + c.interface + "'");
  if (c.camera_source == "ring" && c.ring.empty()) refuse("'camera.source' is ring, but 'camera.ring' names no file");
  if (c.camera_source == "device" && c.device.empty()) refuse("'camera.source' is device, but 'camera.device' names none");
  if (!page_sized(c.ring_bytes)) refuse("'camera.ring_bytes' is not a multiple of 4096");
  if (!page_sized(c.ring_offset) || c.ring_offset >= c.ring_bytes)
    refuse("'camera.ring_offset' is not a multiple of 4096 below 'camera.ring_bytes'");
  if (c.operator_socket.empty() || c.operator_socket.size() > longest_socket)
    refuse("'operator.socket' takes a path of 1 to " + std::to_string(longest_socket) + " letters, folder included, and this one has " +
           std::to_string(c.operator_socket.size()));
  if (c.log_folder.empty()) refuse("'log.folder' names no folder");
  if (c.lock_folder.empty()) refuse("'lock_folder' names no folder");
  if (c.machine.camera.distortion.size() != 5) refuse("'camera.distortion' takes 5 numbers: k1, k2, p1, p2, k3");
  check_calibration(c.machine, c.machines_camera, refuse);
  const PanelLayout& panel = c.machine.panel;
  if ((panel.plate_min_m.array() >= panel.plate_max_m.array()).any()) refuse("'panel.plate_min_m' is not below 'panel.plate_max_m'");
  for (std::size_t i = 0; i < panel.markers.size(); ++i) {
    const auto marker = [&](const char* field) { return config::marker_key(c.machine.survey, i, field); };
    if (panel.markers[i].plate_m <= panel.markers[i].size_m) refuse(marker("plate_m") + " is not larger than " + marker("size_m"));
  }
  for (const std::string& problem : config::handle_problems(c.machine)) refuse(problem);
  for (const std::string& problem : config::panel_problems(panel, c.machine.survey)) refuse(problem);
  for (const std::string& problem : config::low_button_problems(c.machine)) refuse(problem);
  const double between_ms = c.machine.mission.camera_syncs * can_map::sync_period.s() * 1e3;
  if (c.match_window_us * 1e-3 >= between_ms / 2)
    refuse("'camera.match_window_us' is half the time between two exposures or more: an image could belong to either");
}

// A file that is missing may be one that was misspelt. Its place is kept, so that commissioning writes where was read.
void find_homing(VehicleConfig& c, std::vector<std::string>& problems) {
  config::Machine& machine = c.machine;
  if (machine.homing_file.empty()) return;
  c.homing_named = true;
  const std::filesystem::path folder = std::filesystem::path(machine.file).parent_path();
  const std::filesystem::path found = config::find_file(machine.homing_file, folder);
  std::error_code error;  // a name that is no file's, too long for instance, is not there
  const std::filesystem::path place = std::filesystem::canonical(found, error);
  if (!error && !std::filesystem::is_directory(place, error)) {
    machine.homing_file = place.string();
    return;
  }
  if (!error) {
    problems.push_back(machine.file + ": 'homing.file': " + place.string() + " is a folder, not a file");
    machine.homing_file.clear();
    return;
  }
  problems.push_back(
      machine.file + ": 'homing.file': there is no " + machine.homing_file +
      ", neither beside this file nor among the shipped ones. An arm that was never commissioned has an empty one: make it with `touch`");
  machine.homing_file.clear();
}

// Relative paths are beside the file that names them, wherever the program was started. Empty ones name nothing.
void find_places(VehicleConfig& c, std::vector<std::string>& problems) {
  namespace fs = std::filesystem;
  std::error_code error;  // the working directory may be gone: then a path stays as it is
  const fs::path file = fs::absolute(c.machine.file, error).lexically_normal();
  if (error) return;
  // Two links in two folders, or one that is put elsewhere while a daemon runs: the other daemon would not meet the lock.
  if (fs::path(c.lock_folder).is_relative() && !c.lock_folder.empty() && fs::canonical(c.machine.file, error) != file)
    problems.push_back(c.machine.file +
                       ": 'lock_folder' is relative, and this file is reached by a link: two daemons of one bus could take two locks. Give "
                       "it as a full path");
  for (std::string* place : {&c.device, &c.ring, &c.operator_socket, &c.estop_input, &c.log_folder, &c.lock_folder}) {
    if (!place->empty()) *place = (file.parent_path() / *place).lexically_normal().string();
  }
}

// The file's root, a map or nothing.
std::vector<std::string> texts_of(config::Machine& machine) {
  std::vector<std::string> texts;
  for (const config::Key& key : config::machine_keys(machine)) texts.push_back(config::value_text(key));
  return texts;
}

// A real robot is said once: a key that was left in the file, and says another thing than the machine's, would move another arm.
void refuse_contradictions(VehicleConfig& c, const std::vector<std::string>& machines, std::vector<std::string>& problems) {
  const Keys table = config::machine_keys(c.machine);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string own = config::value_text(table[i]);
    if (own != machines[i])
      problems.push_back(c.machine.file + ": '" + table[i].path + "' is " + own + " here and " + machines[i] + " in " +
                         c.machine.told_also + ": leave it out in one of them");
  }
}

// `follow`: reads the machine's file as well, where one is named.
YAML::Node read_keys(const std::string& path, VehicleConfig& config, std::vector<std::string>& problems, bool follow = true) {
  config.machine.file = path;
  const config::Source source = config::Source::of_file(path, problems);
  const YAML::Node root = config::parse_yaml(config::read_text_file(path), source);
  if (!root.IsNull() && !root.IsMap()) source.refuse(root.Mark(), "a vehicle's configuration is a group of keys");
  if (!root.IsMap()) return root;
  const std::string name = follow ? config::machine_named_in(root) : "";
  if (!name.empty()) {
    try {
      const std::filesystem::path found = config::named_machine(path, name);
      config.machine.told_also = found.string();
      config::read_machine_file(found, config.machine, problems);
      config.machines_camera = config.machine.camera;
    } catch (const InputError& problem) {
      problems.emplace_back(problem.what());
    }
  }
  // A stop asks for nothing but its socket: drives go by names that only the arm's file has.
  YAML::Node readable = root;
  std::vector<std::string> told_later;  // by the core's own checks
  if (follow)
    config.machine.joints = config::joints_or_why(readable, path, config.machine.joints, told_later);
  else
    readable.remove("drives");
  if (config.machine.arm_told) config::forget_joints(readable);
  // A file's names are not known yet: any is taken, and looked for later.
  if (!config::panel_named_in(root).empty()) config.machine.survey.names = {{}, {}, {}};
  const std::vector<std::string> machines = texts_of(config.machine);
  config::read_map(root, "", "", keys(config), source);
  if (!name.empty()) refuse_contradictions(config, machines, problems);
  return root;
}

bool gives_socket(const YAML::Node& root) {
  if (!root.IsMap()) return false;
  const YAML::Node group = root["operator"];
  return group && group.IsMap() && group["socket"] && group["socket"].IsScalar();
}

}  // namespace

SocketCan::Config VehicleConfig::can() const {
  SocketCan::Config can;
  can.interface = interface;
  std::vector<std::uint8_t> nodes{core.controller.network.io.node};
  for (const canopen::DriveSetup& drive : core.controller.network.drives) nodes.push_back(drive.node);
  can.filters = core_filters(nodes);
  can.transmit_deadline = Duration::from_s(transmit_deadline_ms * 1e-3);
  return can;
}

V4l2Camera::Config VehicleConfig::v4l2() const {
  V4l2Camera::Config camera;
  camera.device = device;
  camera.width = core.controller.camera.intrinsics.width;
  camera.height = core.controller.camera.intrinsics.height;
  camera.exposure = core.controller.camera.exposure;
  camera.gain = gain;
  camera.stamp_delay = Duration::from_us(stamp_delay_us);
  return camera;
}

RingCamera::Config VehicleConfig::ring_camera() const {
  return {ring, static_cast<std::size_t>(ring_bytes), static_cast<std::size_t>(ring_offset)};
}

Keys keys(VehicleConfig& config) {
  Keys all;
  add_bus(all, config);
  add_camera_source(all, config);
  config::add_tasks(all, config.machine.tasks, config.machine.survey.names, "the job, in order");
  add_machine(all, config);
  add_running(all, config);
  return all;
}

VehicleConfig load_vehicle_config(const std::string& path) {
  std::vector<std::string> problems;
  VehicleConfig config = load_vehicle_config(path, problems);
  if (!problems.empty()) throw InputError(config::joined(problems));
  return config;
}

StopSocket stop_socket(const std::string& path) {
  StopSocket found;
  VehicleConfig config;
  bool given = false;
  try {
    given = gives_socket(read_keys(path, config, found.problems, false));
  } catch (const InputError& error) {
    found.problems.emplace_back(error.what());
    return found;
  }
  // A key that is not known may be a misspelt one of the socket. The file's own name, with which each problem begins, says nothing.
  const auto may_hide_it = [&](const std::string& problem) {
    const std::string text = problem.substr(std::min(path.size(), problem.size()));
    return text.find("operator") != std::string::npos || text.find("unknown key") != std::string::npos;
  };
  found.told = given || std::none_of(found.problems.begin(), found.problems.end(), may_hide_it);
  // The daemon may run by another name of the file than the one that is given here.
  std::error_code error;
  const std::string real = std::filesystem::canonical(path, error).string();
  for (const std::string& name : {path, error ? path : real}) {
    VehicleConfig named = config;
    named.machine.file = name;
    std::vector<std::string> of_other_places;
    find_places(named, of_other_places);
    if (std::find(found.paths.begin(), found.paths.end(), named.operator_socket) == found.paths.end())
      found.paths.push_back(named.operator_socket);
  }
  return found;
}

std::string print_vehicle_config(const std::string& path) {
  std::vector<std::string> problems;
  VehicleConfig config, defaults;
  if (!path.empty()) read_keys(path, config, problems);
  if (!problems.empty()) throw InputError(config::joined(problems));
  return config::key_listing(keys(config), keys(defaults));
}

std::string vehicle_schema() {
  VehicleConfig config;
  return config::key_schema(keys(config), "Lanternfish vehicle");
}

VehicleConfig load_vehicle_config(const std::string& path, std::vector<std::string>& problems) {
  VehicleConfig config;
  read_keys(path, config, problems);
  find_places(config, problems);
  const bool panel_known = config::settle_panel(path, config.panel_file, config.docked_panel, config.valve_stops, config.machine.panel,
                                                config.machine.survey, problems);
  if (!panel_known) config.machine.tasks = config::Machine().tasks;  // its own name what nobody has read
  const config::NamedArm arm = config::arm_for_checks(path, config.machine.arm_urdf);
  config.machine.arm = arm.arm;
  config.machine.joints = arm.joints;
  check_together(config, path, problems);
  find_homing(config, problems);
  config.core = config::make_core(config.machine, problems);
  config.core.scan.match_window = Duration::from_us(config.match_window_us);
  config.core.controller.mission.image_due = Duration::from_ms(config.image_due_ms);
  return config;
}

}  // namespace lf::hal
