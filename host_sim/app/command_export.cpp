#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <system_error>

#include "hal/config/core_drives.hpp"
#include "hal/config/drive_kind.hpp"
#include "hal/config/limits_file.hpp"
#include "hal/config/nearest.hpp"
#include "hal/config/share.hpp"
#include "host_sim/app/checks.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/dbc.hpp"
#include "host_sim/app/eds.hpp"
#include "host_sim/app/read_machine.hpp"
#include "host_sim/devices/drive/drive_objects.hpp"
#include "host_sim/record/file_sink.hpp"
#include "shared/arm/motor.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace {

struct Options {
  std::string kind, machine, out;
};

// A DBC's names are those of C. Two joints whose names differ in other letters only, and one that is called as the master is, get a longer one.
std::string dbc_name(const std::string& joint, const std::vector<DbcDrive>& taken) {
  std::string name = joint;
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) != 0) name.insert(0, "_");
  const auto is_taken = [&] {
    return name == "master" || std::any_of(taken.begin(), taken.end(), [&](const DbcDrive& other) { return other.name == name; });
  };
  while (is_taken()) name += "_";
  return name;
}

// The drives as the master sets them up: their units, directions and numbers.
canopen::NetworkConfig network_of(const config::Machine& machine, const ArmDescription& description) {
  const safety::Limits limits =
      config::read_limits(config::named_file(machine.file, "safety.limits", machine.safety_limits), machine.joints);
  canopen::NetworkConfig network = config::network_config(machine.arm, limits);
  for (std::size_t i = 0; i < machine.joints.size(); ++i) {
    const config::DriveKind kind =
        config::find_drive_kind(config::drive_of(machine.drives, i).profile, std::filesystem::path(machine.file).parent_path());
    config::set_drive(machine, i, kind, description.joints[i], network.drives[i]);
  }
  network.io.node = static_cast<std::uint8_t>(machine.drives.output_node);
  config::check_network(machine, network);
  return network;
}

DbcDrive drive_of(const canopen::DriveSetup& setup, const ArmJoint& joint, const config::JointDriveChoice& choice) {
  const canopen::DriveScale& scale = setup.profile.scale;
  const double rated_nm = choice.rated_torque_nm > 0 ? choice.rated_torque_nm : motor_of(joint, choice.counts_per_rev).rated_torque_nm;
  DbcDrive drive;
  drive.node = setup.node;
  drive.screw = joint.actuator.counts_per_rad == 0;
  const double per_count = 1 / (drive.screw ? joint.actuator.counts_per_m : joint.actuator.counts_per_rad);
  drive.position = scale.sign * per_count * scale.position.den / scale.position.num;
  drive.torque_nm = scale.sign * rated_nm / 1000 * scale.torque.den / scale.torque.num;
  drive.torque_offset = setup.profile.torque_offset;
  return drive;
}

// Named as in the DBC, so that a tool shows both alike.
std::vector<DbcDrive> drives_of(const config::Machine& machine, const ArmDescription& description, const canopen::NetworkConfig& network) {
  std::vector<DbcDrive> drives;
  for (std::size_t i = 0; i < machine.joints.size(); ++i) {
    DbcDrive drive = drive_of(network.drives[i], description.joints[i], config::drive_of(machine.drives, i));
    drive.name = dbc_name(machine.joints[i], drives);
    drives.push_back(std::move(drive));
  }
  return drives;
}

int export_dbc(const std::string& text, const std::string& out) {
  if (out.empty()) {
    print("%s", text.c_str());
    return done;
  }
  record::write_file_atomically(out, text);
  print("%s\n", out.c_str());
  return done;
}

std::string eds_file(std::uint8_t node, const std::string& name) { return "node" + std::to_string(node) + "_" + name + ".eds"; }

// What an earlier export left in the folder would be taken for this machine's.
void note_others(const std::filesystem::path& folder, const std::set<std::string>& written) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename();
    if (name.starts_with("node") && name.ends_with(".eds") && !written.contains(name))
      std::fprintf(stderr, "note: %s is not of this export\n", entry.path().c_str());
  }
}

// Whoever's identity (object 1018) a drive has, wrote its data sheet.
bool is_own(const config::DriveKind& kind) {
  const can_map::Sheet sheet = can_map::sheet();
  return kind.identity.vendor == sheet.vendor && kind.identity.product == sheet.product;
}

// Of the nodes that are the project's own. Another make's drive has its maker's.
int export_eds(const config::Machine& machine, const ArmDescription& description, const std::vector<DbcDrive>& names, std::uint8_t outputs,
               const std::filesystem::path& folder) {
  std::error_code failed;
  if (std::filesystem::exists(folder, failed) && !std::filesystem::is_directory(folder, failed))
    throw InputError(folder.string() + ": is a file, not a folder");
  std::filesystem::create_directories(folder, failed);
  if (failed) throw InputError(folder.string() + ": cannot be made: " + failed.message());
  std::set<std::string> written;
  const auto write = [&](const EdsNode& node) {
    const std::string path = (folder / node.file).string();
    record::write_file_atomically(path, eds(node));
    written.insert(node.file);
    print("%s\n", path.c_str());
  };
  for (std::size_t i = 0; i < machine.joints.size(); ++i) {
    const config::JointDriveChoice choice = config::drive_of(machine.drives, i);
    const config::DriveKind kind = config::find_drive_kind(choice.profile, std::filesystem::path(machine.file).parent_path());
    if (!is_own(kind)) {
      std::fprintf(stderr, "note: no data sheet for node %u (%s): its drive is of another make, %s, whose maker has one\n",
                   unsigned{names[i].node}, machine.joints[i].c_str(), kind.title.c_str());
      continue;
    }
    devices::DriveConfig drive = devices::drive_config(description.joints[i], names[i].node);
    devices::set_motor(description.joints[i], choice.counts_per_rev, drive);
    if (choice.rated_torque_nm > 0) drive.rated_torque_nm = choice.rated_torque_nm;
    write({names[i].node, eds_file(names[i].node, names[i].name), std::string(can_map::servo_drive_title()) + ", " + machine.joints[i],
           can_map::servo_drive_objects(), can_map::servo_drive_heads(),
           [&](can_map::Figure figure) { return devices::figure_of(figure, drive); }});
  }
  write({outputs, eds_file(outputs, "outputs"), can_map::output_node_title(), can_map::output_node_objects(), can_map::output_node_heads(),
         [](can_map::Figure) { return std::int64_t{0}; }});
  note_others(folder, written);
  return done;
}

int do_export(const Options& options) {
  config::check_names({options.kind}, {"dbc", "eds"}, "export");
  if (options.kind == "eds" && options.out.empty()) throw InputError("export eds: --out FOLDER is missing: there is a file a node");
  const config::Machine machine = read_machine(machine_path(options.machine));
  const ArmDescription description = load_arm_urdf(config::named_file(machine.file, "arm.urdf", machine.arm_urdf));
  const canopen::NetworkConfig network = network_of(machine, description);
  const std::vector<DbcDrive> drives = drives_of(machine, description, network);
  if (options.kind == "eds") return export_eds(machine, description, drives, network.io.node, options.out);
  return export_dbc(dbc(drives, network.io.node), options.out);
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "export", "Write what is on a machine's bus for other tools: a DBC, with which they decode its frames, or its nodes' data sheets");
  auto options = std::make_shared<Options>();
  command->add_option("KIND", options->kind, "What to write: dbc, eds")->required();
  command->add_option("MACHINE", options->machine, "A machine's file, or a shipped machine's name")->required();
  command->add_option("--out", options->out, "The DBC, stdout where it is not given; the folder of the data sheets")
      ->check(check_printable);
  command->callback([options, &action] { action = [options] { return do_export(*options); }; });
}

}  // namespace lf::app
