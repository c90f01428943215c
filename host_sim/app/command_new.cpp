#include <filesystem>
#include <memory>
#include <sstream>

#include "hal/config/machine_file.hpp"
#include "hal/config/nearest.hpp"
#include "host_sim/app/checks.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/shell_word.hpp"
#include "host_sim/record/file_sink.hpp"
#include "host_sim/scenario/describe.hpp"
#include "host_sim/scenario/scenario.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace fs = std::filesystem;

namespace {

// THIS_FILE stands for the file, as a shell reads it.

// Every key but the job has its default, commented out.
std::string new_scenario() {
  std::string text =
      "# A mission of your own: `lanternfish run THIS_FILE --seed 1` flies it as it stands. Each line below that begins with '#' has a "
      "key and its default:\n"
      "# take the '#' away, and that of the group it is in, to change it. docs/scenarios.md explains them.\n\n"
      "description: a mission of my own\n\n"
      "tasks:\n"
      "  - turn_valve: {to_deg: 90}\n"
      "  - press_buttons: {order: [left, centre, right]}\n\n";
  const scenario::Scenario defaults;
  std::istringstream lines(scenario::scenario_yaml(defaults));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("description:") && !line.starts_with("tasks:")) text += "#" + line + "\n";
  }
  return text;
}

std::string new_scene() {
  return "# What else stands about: name this file with `scene:` in a scenario, or fly `lanternfish run default --set scene=THIS_FILE`.\n"
         "# `lanternfish check scene THIS_FILE --picture scene.png` tells and draws it. docs/scenarios.md has every key.\n"
         "# Places on the panel: x to the right, y up, z toward the robot, from the valve's base. On the vehicle: x toward the panel, y "
         "right, z down, from the\n"
         "# arm's base.\n"
         "version: 1\n"
         "objects:\n"
         "  - name: pipe\n"
         "    kind: cylinder              # box (size_m), sphere (radius_m), cylinder and capsule (radius_m, length_m), mesh (file, "
         "scale)\n"
         "    radius_m: 0.02\n"
         "    length_m: 0.7               # along its z\n"
         "    frame: panel                # or vehicle\n"
         "    position_m: [0, -0.3, 0.05]\n"
         "    turn_deg: [0, 90, 0]        # about x, then y, then z\n"
         "    albedo: [0.35, 0.36, 0.38]  # red, green, blue\n"
         "    friction: 0.6\n"
         "#  - name: rock\n"
         "#    kind: mesh\n"
         "#    file: rock.stl             # OBJ, STL or PLY, closed; relative to this file\n"
         "#    scale: 0.001               # metres for one of its units\n"
         "#    position_m: [-0.27, -0.18, 0.03]\n";
}

std::string new_panel() {
  return "# What is on your panel: name this file with `panel: {file: THIS_FILE}` in a scenario, or fly\n"
         "#   lanternfish run default --set panel.file=THIS_FILE --set 'tasks=[{turn_valve: {valve: V1, to_deg: 45}}, {press_buttons: "
         "{order: [B1]}}]'\n"
         "# `lanternfish check panel THIS_FILE --picture panel.png` tells and draws it, and says what of it the robot can work. "
         "docs/your-panel.md\n"
         "# explains each key. Places are [right, up] in metres from the panel's origin, which the robot docks before: panel.ahead_m, "
         "right_m and\n"
         "# down_m of the scenario say where it is. Keys that are left out have the value that stands here behind '#'.\n"
         "version: 1\n"
         "plate:\n"
         "  min_m: [-0.40, -0.378]   # lower left corner\n"
         "  max_m: [0.40, 0.222]     # upper right corner\n"
         "#  thickness_m: 0.02\n"
         "valves:                    # T-bars, up to 16; kind: d_handle, fishtail or paddle changes the usual sizes (docs/your-panel.md)\n"
         "  - name: V1\n"
         "    at_m: [0, 0]           # its axis\n"
         "    torque_nm: 3           # the most that it takes to turn: more than the arm gives is refused\n"
         "#    length_m: 0.0966       # of the bar\n"
         "#    thickness_m: 0.0126\n"
         "#    height_m: 0.1          # of its centre line over the plate\n"
         "#    pointer: light_end     # the painted end, which points up at 0 degrees: none, light_end or dark_end\n"
         "#    pointer_length_m: 0.03\n"
         "#    stop_min_deg: -105     # its range; 0 is a vertical bar, positive counter-clockwise\n"
         "#    stop_max_deg: 105\n"
         "#    friction_nm: {min: 0.5, max: 3}   # this and the next are for simulation alone\n"
         "#    start_deg: {min: -40, max: 40}\n"
         "#    detents_deg: [-90, 0, 90]\n"
         "buttons:                   # up to 16\n"
         "  - name: B1\n"
         "    at_m: [-0.067, 0.141]\n"
         "#    width_m: 0.04          # of its cap\n"
         "#    height_m: 0.03         # over the plate\n"
         "#    stroke_m: 0.005\n"
         "markers:                   # AprilTags 36h11, one to 16: a look needs one of them\n"
         "  - id: 7\n"
         "    at_m: [-0.17, 0.072]\n"
         "#    size_m: 0.08           # of its black square\n"
         "#    plate_m: 0.1\n";
}

std::string new_machine() {
  return "# What your robot is: name this file with `machine: THIS_FILE` in a scenario and in the vehicle's configuration, or fly\n"
         "#   lanternfish run default --set machine=THIS_FILE\n"
         "# `lanternfish check machine THIS_FILE --picture machine.png` tells and draws it, and says whether it can do the default job.\n"
         "# docs/your-arm.md leads from a maker's URDF to a mission. All that stands here is the default machine: what you leave out stays "
         "so.\n"
         "version: 1\n" +
         config::machine_listing();
}

struct Options {
  std::string kind, name;
};

int make(const Options& options) {
  config::check_names({options.kind}, {"machine", "panel", "scenario", "scene"}, "new");
  fs::path file = options.name;
  if (!file.has_filename() || file.filename() == "." || file.filename() == "..")
    throw InputError("'" + options.name + "' names a folder: give a file");
  if (!file.has_extension()) file += ".yaml";
  if (file.extension() != ".yaml" && file.extension() != ".yml")
    throw InputError("'" + options.name + "' ends in " + file.extension().string() + ": a " + options.kind + " ends in .yaml");
  std::error_code none;
  if (fs::exists(fs::symlink_status(file, none))) throw InputError(file.string() + ": is there already: another name, or take it away");
  std::string text = options.kind == "scene"     ? new_scene()
                     : options.kind == "panel"   ? new_panel()
                     : options.kind == "machine" ? new_machine()
                                                 : new_scenario();
  const std::string place = "THIS_FILE", word = shell_word(file.string());
  for (std::size_t at = text.find(place); at != std::string::npos; at = text.find(place, at + word.size()))
    text.replace(at, place.size(), word);
  record::write_file_atomically(file, text);
  print("%s\n", file.c_str());
  return done;
}

}  // namespace

void add_new(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "new", "Write a commented file of your own to begin with: a scenario or a machine that flies as it stands, a panel or a scene");
  auto options = std::make_shared<Options>();
  command->add_option("KIND", options->kind, "What to write: machine, panel, scenario or scene")->required();
  command->add_option("NAME", options->name, "The file, which ends in .yaml; that is added where it has no ending")
      ->required()
      ->check(check_printable);
  command->callback([options, &action] { action = [options] { return make(*options); }; });
}

}  // namespace lf::app
