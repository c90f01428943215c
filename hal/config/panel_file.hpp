// A panel's file: its plate, and lists of named valves, buttons and markers. Both programs read it; what a valve is in simulation alone the core is not told.
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>
#include <vector>

#include "hal/config/key.hpp"
#include "hal/config/panel_survey.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::config {

struct PanelFile {
  PanelLayout layout;  // at the docked mission's nominal place
  PanelSurvey survey;
};

// An entry of a list, as it is written down.
struct ValveEntry {
  std::string name;
  std::string kind = "t_bar";
  double depth_m = 0;
  PanelLayout::Valve layout;
  ValveStops stops;
  ValveNature nature;
};
struct ButtonEntry {
  std::string name;
  PanelLayout::Button layout;
};

// Throws InputError with every problem, a line each: no file, not YAML, an unknown or repeated key, a value out of its range, an entry without a name or a place, a
// name twice, more entries than a panel holds, no marker, and parts that do not leave one another free.
PanelFile read_panel_file(const std::filesystem::path& file);

// The panel that a scenario or a configuration means, `told_in` its file: what `file` names, or, where that is empty, the keys of the docked mission's panel. Where it
// stands is told by these keys in either case. Adds to `problems` what read_panel_file() throws, and keys that the file makes meaningless. False where the file cannot be
// read: `layout` is the docked mission's then, and the tasks need not fit it.
bool settle_panel(const std::string& told_in, const std::string& file, const DockedPanel& docked, const ValveStops& stops,
                  PanelLayout& layout, PanelSurvey& survey, std::vector<std::string>& problems);

// What 'panel.file' of a YAML document says, in either form of its path; empty where it says nothing.
std::string panel_named_in(const YAML::Node& root);

// A shipped panel's name, "pandora", as the file that it means; any other name stays.
std::string panel_file_of(const std::string& name);
// Names of the shipped ones.
std::vector<std::string> shipped_panels();

Keys keys(PanelLayout& layout);  // the plate's
Keys keys(ValveEntry& valve);
Keys keys(ButtonEntry& button);
Keys keys(PanelLayout::Marker& marker);

// The tables as JSON Schema, and as the rows of the page.
std::string panel_schema();
std::string panel_keys_markdown();

}  // namespace lf::config
