#include "host_sim/app/manual.hpp"

#include "hal/command_line/man_page.hpp"
#include "hal/config/fault_kinds.hpp"
#include "host_sim/scenario/keys.hpp"

namespace lf::app {

namespace {

using command_line::Manual;

Manual program_manual() {
  Manual page{"lanternfish", "1", "simulator of an underwater robot that works on panels", "User commands", {}, {}};
  page.before = {{"DESCRIPTION",
                  "Flies the control core of an underwater robot against simulated physics, CANopen drives and a ray-traced camera, and "
                  "offers each stage of its "
                  "perception on its own.\n\n"
                  "With `--json` a command prints one JSON document on standard output and nothing else there; everything said on the way "
                  "goes to standard error. "
                  "What is refused is a document, too: its `problems` and the `exit_status`. A run tells each phase as it ends and a "
                  "campaign each minute how far it is; `run --quiet` does not. A reader that goes away, as "
                  "`head` does, ends no command.\n\n"
                  "A SCENARIO is a file or the name of a shipped one: see `lanternfish-scenario(5)`. `--set path.to.key=value` changes a "
                  "key of it, the value written as "
                  "in the file. A file that `--set` names is looked for in the present folder first."}};
  page.after = {
      {"EXIT STATUS",
       "",
       {{"0", "Done; of a run: the mission succeeded, or failed as its scenario expects."},
        {"1", "The mission or the check failed; an arm that does not reach, a cloud without a plane."},
        {"2", "Bad input. Every problem is told on a line of its own, with the place in the file where it has one."},
        {"3", "This machine lacks something, and what to do. A disk that is full is this."},
        {"130", "Interrupted by Ctrl-C."}}},
      {"ENVIRONMENT",
       "",
       {{"LANTERNFISH_SHARE",
         "Folder of the shipped files. Without it they are looked for beside the program: share/lanternfish of its installation, or "
         "shared/ of the "
         "checkout that it stands in."}}},
      {"FILES",
       "",
       {{"/usr/share/lanternfish", "Scenarios with their JSON Schema, the arm, its safety limits, drive profiles, EDS and DBC files."},
        {"runs/SCENARIO-SEED",
         "What a run leaves: report.html, result.json, experiment.json (the resolved scenario and the hashes of all that was used), "
         "scenario.yaml (to fly it again), cloud.pcd, can0.log, log.jsonl, "
         "joints.csv, images."},
        {"/usr/share/doc/lanternfish/commands.md", "More about each command."}}},
      {"EXAMPLES",
       "  lanternfish run turbid --seed 7\n"
       "  lanternfish run --set valve.friction_nm=3 --set \"tasks=[turn_valve: {to_deg: 45}]\"\n"
       "  lanternfish campaign default --seeds 1-50 --out runs/default\n"
       "  lanternfish serve default --can vcan0 --camera ring:/dev/shm/camera\n"
       "  lanternfish peaks on.png --off off.png --overlay peaks.png"},
      {"SEE ALSO", "`lanternfish-scenario(5)`, `lanternfishd(8)`"}};
  return page;
}

Manual scenario_manual() {
  Manual page{"lanternfish-scenario", "5", "what a simulated mission is flown in", "File formats", {}, {}};
  page.before = {{"DESCRIPTION",
                  "A YAML file that says where the robot is docked, what the water is like, how well the machine was assembled, what the "
                  "job is, and what goes wrong. "
                  "What is not named has its default. A key that is not known, and a value out of its range, is refused with file and "
                  "line, all of them at once.\n\n"
                  "`lanternfish scenarios FILE` checks one as a run of it would, and prints it with every key. "
                  "/usr/share/lanternfish/scenarios/scenario.schema.json has the same keys for editors.\n\n"
                  "Where a key takes a number or {min: , max: } the seed draws evenly between the two. Each quantity has a generator of "
                  "its own: changing one leaves all "
                  "others of a seed as they were.\n\n"
                  "Names of files are relative to the scenario's folder, then to the shipped files."},
                 {"EXAMPLE",
                  "  # a stiff valve in murky water\n"
                  "  description: a stiff valve in murky water\n"
                  "  water:\n"
                  "    attenuation_per_m: {min: 0.5, max: 0.7}\n"
                  "  valve:\n"
                  "    friction_nm: 2.5\n"
                  "  tasks:\n"
                  "    - turn_valve: {to_deg: 90}\n"
                  "    - press_buttons: {order: [centre]}\n"
                  "  faults:\n"
                  "    - {at_step: turn, after_s: 0.5, kind: silent, node: io}"}};
  command_line::ManSection kinds{"KINDS OF FAULTS", "", {}};
  for (const config::FaultKind& kind : config::fault_kinds()) kinds.items.push_back({kind.name, kind.does});
  page.after = {kinds, {"SEE ALSO", "`lanternfish(1)`"}};
  return page;
}

std::string scenario_page() {
  scenario::Scenario scenario;
  config::Task task;
  config::Fault fault;
  return command_line::man_page(scenario_manual(), keys(scenario), {{"KEYS OF A TASK", keys(task, {})}, {"KEYS OF A FAULT", keys(fault)}});
}

}  // namespace

command_line::ManPages manual_of(const CLI::App& app) {
  return {{"1", [&app] { return command_line::man_page(program_manual(), app); }}, {"5", scenario_page}};
}

command_line::WordSources word_sources() {
  const std::string scenarios = "lanternfish scenarios 2>/dev/null | cut -d\" \" -f1";
  const std::string keys = "lanternfish scenarios --keys 2>/dev/null | sed -n \"s/^| .\\([a-z_.]*\\). | .*/\\1=/p\"";
  command_line::WordSources sources{{"SCENARIO", {scenarios, true}}, {"--set", {keys}}};
  // Numbers, and names that no list has: a command that prints nothing.
  for (const char* option : {"--seeds", "--shard", "--rows", "--steps", "--kinds"}) sources[option] = {"true"};
  return sources;
}

}  // namespace lf::app
