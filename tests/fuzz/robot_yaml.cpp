// What the robot is and what it stands before: a machine's file and a panel's. Each reader gets every input, and takes it or refuses it with an InputError.
#include <cmath>
#include <variant>

#include "hal/config/machine_file.hpp"
#include "hal/config/panel_file.hpp"
#include "shared/input_error.hpp"
#include "tests/fuzz/input.hpp"

namespace {

void machine(const std::string& path) {
  lf::config::Machine machine;
  std::vector<std::string> problems;
  lf::config::read_machine_file(path, machine, problems);
  for (const std::string& problem : problems) lf::fuzz::expect(!problem.empty(), "a refusal says why");
  if (!problems.empty()) return;
  for (const lf::config::Key& key : lf::config::machine_keys(machine)) {
    if (const auto* const* number = std::get_if<double*>(&key.value))
      lf::fuzz::expect(**number >= key.min && **number <= key.max, "what was taken is within its range");
  }
}

void panel(const std::string& path) {
  try {
    const lf::config::PanelFile panel = lf::config::read_panel_file(path);
    lf::fuzz::expect(!panel.layout.markers.empty(), "a panel has a marker");
    lf::fuzz::expect(panel.survey.names.valves.size() == panel.layout.valves.size(), "each valve has a name");
    for (const lf::PanelLayout::Valve& valve : panel.layout.valves)
      lf::fuzz::expect(std::isfinite(valve.at_m.sum() + valve.handle_min_rad) && valve.handle_min_rad < valve.handle_max_rad,
                       "a valve's figures");
  } catch (const lf::InputError& refused) {
    lf::fuzz::expect(refused.what()[0] != '\0', "a refusal says why");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static lf::fuzz::MemoryFile file;
  const std::string path = file.holding({data, size});
  machine(path);
  panel(path);
  return 0;
}
