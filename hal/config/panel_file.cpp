#include "hal/config/panel_file.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "hal/config/joined.hpp"
#include "hal/config/key_schema.hpp"
#include "hal/config/key_text.hpp"
#include "hal/config/machine.hpp"
#include "hal/config/nearest.hpp"
#include "hal/config/panel_check.hpp"
#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "hal/config/yaml_reader.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t version = 1;
constexpr std::size_t longest_name = 40;
const std::vector<std::string> root_names{"version", "plate", "valves", "buttons", "markers"};

fs::path named_panel(const std::string& told_in, const std::string& file) {
  const std::string path = panel_file_of(file);
  if (path == file) return named_file(told_in, "panel.file", file);
  const std::vector<std::string> shipped = shipped_panels();
  if (std::find(shipped.begin(), shipped.end(), file) != shipped.end()) return share_folder() / path;
  const std::string near = suggestion(file, shipped);
  throw InputError(told_in + ": 'panel.file': no shipped panel '" + file + "'" +
                   (near.empty() ? "; there are " + joined(shipped, ", ") + ", or give a file" : near));
}

class Reader {
 public:
  Reader(const fs::path& file, std::vector<std::string>& problems) : source_(Source::of_file(file, problems)), problems_(problems) {
    panel_.layout.valves.clear();
    panel_.layout.buttons.clear();
    panel_.layout.markers.clear();
    panel_.survey = {file, {{}, {}, {}}, {}};
  }

  const Source& source() const { return source_; }

  PanelFile& read(const YAML::Node& root) {
    if (!root.IsMap()) refuse(root, "a panel is a group of keys: version, plate, valves, buttons and markers");
    check_root(root);
    const YAML::Node plate = root["plate"];
    attempt([&] {
      if (!plate || plate.IsNull()) return;
      if (!plate.IsMap()) refuse(plate, "'plate' takes a group of keys: min_m, max_m and thickness_m");
      read_map(plate, "plate.", "", keys(panel_.layout), source_);
    });
    each(root, "valves", PanelLayout::max_valves, [&](const YAML::Node& node, const std::string& shown) { add_valve(node, shown); });
    each(root, "buttons", PanelLayout::max_buttons, [&](const YAML::Node& node, const std::string& shown) { add_button(node, shown); });
    each(root, "markers", PanelLayout::max_markers, [&](const YAML::Node& node, const std::string& shown) { add_marker(node, shown); });
    if (problems_.empty()) check_whole(root);
    return panel_;
  }

  // Goes on after a problem, so that all are told.
  template <typename Step>
  void attempt(Step step) {
    try {
      step();
    } catch (const InputError& problem) {
      problems_.emplace_back(problem.what());
    }
  }

 private:
  [[noreturn]] void refuse(const YAML::Node& node, const std::string& message) const { source_.refuse(node.Mark(), message); }

  void check_root(const YAML::Node& root) {
    std::int64_t given = 0;
    std::set<std::string> seen;
    for (const auto& entry : root) {
      const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : "";
      const bool known = std::find(root_names.begin(), root_names.end(), name) != root_names.end();
      if (!known)
        attempt([&] { refuse(entry.first, "unknown key '" + name + "'" + suggestion(name, root_names)); });
      else if (!seen.insert(name).second)
        attempt([&] { refuse(entry.first, "'" + name + "' is given twice"); });
      else if (name == "version")
        attempt([&] { read_value(entry.second, name, key(name, "", version, version, &given, ""), source_); });
    }
    if (!root["version"]) attempt([&] { refuse(root, "has no version: this program reads 'version: 1'"); });
  }

  template <typename Add>
  void each(const YAML::Node& root, const std::string& list, std::size_t most, const Add& add) {
    const YAML::Node entries = root[list];
    if (!entries || entries.IsNull()) return;
    attempt([&] {
      if (!entries.IsSequence()) refuse(entries, "'" + list + "' takes a list");
      if (entries.size() > most)
        refuse(entries, "'" + list + "' has " + std::to_string(entries.size()) + ", and a panel holds " + std::to_string(most));
      for (std::size_t i = 0; i < entries.size(); ++i) {
        const std::string shown = list + "[" + std::to_string(i) + "]";
        attempt([&] {
          if (!entries[i].IsMap()) refuse(entries[i], "'" + shown + "' takes a group of keys");
          add(entries[i], shown);
        });
      }
    });
  }

  // False when something is wrong with it, which is told.
  bool read_entry(const YAML::Node& node, const std::string& shown, const Keys& table, const std::vector<std::string>& required) {
    const std::size_t told = problems_.size();
    read_map(node, "", shown + ".", table, source_);
    for (const std::string& name : required) {
      if (!node[name]) attempt([&] { refuse(node, "'" + shown + "' has no " + name); });
    }
    return problems_.size() == told;
  }

  void check_name(const YAML::Node& node, const std::string& shown, const std::string& name, const std::vector<std::string>& others) const {
    if (name.empty()) refuse(node, "'" + shown + "' has no name");
    // Printable ASCII: names stand in orders, file names and JSON.
    const auto fits = [](unsigned char letter) {
      return letter > ' ' && letter < 0x7F && std::string_view("'\"\\,=").find(static_cast<char>(letter)) == std::string_view::npos;
    };
    if (name.size() > longest_name || !std::all_of(name.begin(), name.end(), fits))
      refuse(node, "'" + shown + ".name': a name is of 1 to " + std::to_string(longest_name) +
                       " letters of ASCII, without blanks, commas, quotes, backslashes and equals signs, for orders name it");
    if (std::find(others.begin(), others.end(), name) != others.end())
      refuse(node, "'" + shown + ".name': there is another '" + name + "'");
  }

  void add_valve(const YAML::Node& node, const std::string& shown) {
    ValveEntry valve;
    set_usual_sizes(node["kind"] && node["kind"].IsScalar() ? node["kind"].Scalar() : valve.kind, valve);
    if (!read_entry(node, shown, keys(valve), {"name", "at_m"})) return;
    check_name(node, shown, valve.name, panel_.survey.names.valves);
    valve.layout.handle_depth_m = static_cast<float>(valve.depth_m);
    if (valve.kind == "d_handle") valve.layout.carried = PanelLayout::Carried::by_posts;
    ValveNature& nature = valve.nature;
    // What nobody has said is no more than what it takes.
    if (!node["friction_nm"])
      nature.friction_nm = {std::min(nature.friction_nm.min, nature.torque_nm), std::min(nature.friction_nm.max, nature.torque_nm)};
    if (valve.stops.stop_min_deg >= valve.stops.stop_max_deg)
      refuse(node, "'" + shown + ".stop_min_deg' is not below '" + shown + ".stop_max_deg'");
    if (nature.start_deg.min < valve.stops.stop_min_deg || nature.start_deg.max > valve.stops.stop_max_deg)
      refuse(node, "'" + shown + ".start_deg' is beyond its stops");
    if (nature.friction_nm.max > nature.torque_nm)
      refuse(node, "'" + shown + ".friction_nm' is more than its 'torque_nm', which is the most that it takes");
    valve.layout.handle_min_rad = rad_from_deg(valve.stops.stop_min_deg);
    valve.layout.handle_max_rad = rad_from_deg(valve.stops.stop_max_deg);
    (void)panel_.layout.valves.push_back(valve.layout);
    panel_.survey.names.valves.push_back(valve.name);
    panel_.survey.valves.push_back(nature);
  }

  // After those that are sold: bars of 16 mm, a D-handle with room for a hand, a fishtail as thick as a bar, a flat lever.
  static void set_usual_sizes(const std::string& kind, ValveEntry& valve) {
    PanelLayout::Valve& v = valve.layout;
    if (kind == "d_handle") v.handle_length_m = 0.120, v.handle_thickness_m = 0.016;
    if (kind == "fishtail") v.handle_length_m = 0.100, v.handle_thickness_m = 0.016, valve.depth_m = 0.030;
    if (kind == "paddle") v.handle_length_m = 0.100, v.handle_thickness_m = 0.010, valve.depth_m = 0.040;
  }

  void add_button(const YAML::Node& node, const std::string& shown) {
    ButtonEntry button;
    if (!read_entry(node, shown, keys(button), {"name", "at_m"})) return;
    check_name(node, shown, button.name, panel_.survey.names.buttons);
    (void)panel_.layout.buttons.push_back(button.layout);
    panel_.survey.names.buttons.push_back(button.name);
  }

  void add_marker(const YAML::Node& node, const std::string& shown) {
    PanelLayout::Marker marker;
    if (!read_entry(node, shown, keys(marker), {"id", "at_m"})) return;
    if (marker.plate_m <= marker.size_m) refuse(node, "'" + shown + ".plate_m' is not larger than '" + shown + ".size_m'");
    (void)panel_.layout.markers.push_back(marker);
    panel_.survey.names.markers.push_back(std::to_string(marker.id));
  }

  void check_whole(const YAML::Node& root) {
    const PanelLayout& layout = panel_.layout;
    if (layout.markers.empty()) attempt([&] { refuse(root, "has no markers: no look would find the panel"); });
    if ((layout.plate_min_m.array() >= layout.plate_max_m.array()).any())
      return attempt([&] { refuse(root["plate"] ? root["plate"] : root, "'plate.min_m' is not below 'plate.max_m'"); });
    for (const std::string& problem : panel_problems(layout, panel_.survey))
      attempt([&] { source_.refuse(place_of(root, problem), problem); });
  }

  // Where the key stands that a problem names first, "'valves.V3.at_m': ...": the key's own line, or that of its valve, button or marker.
  static YAML::Mark place_of(const YAML::Node& root, const std::string& problem) {
    const std::size_t end = problem.find('\'', 1), first = problem.find('.'), last = problem.rfind('.', end);
    if (!problem.starts_with('\'') || end == std::string::npos || first >= last) return YAML::Mark::null_mark();
    const std::string name = problem.substr(first + 1, last - first - 1), field = problem.substr(last + 1, end - last - 1);
    const YAML::Node group = root[problem.substr(1, first - 1)];
    if (!group.IsDefined() || !group.IsSequence()) return YAML::Mark::null_mark();
    for (std::size_t i = group.size(); i-- > 0;) {  // of two markers of one id the second is told
      const YAML::Node entry = group[i];
      const YAML::Node called = entry["name"] ? entry["name"] : entry["id"];
      if (!called.IsDefined() || !called.IsScalar() || called.Scalar() != name) continue;
      return (entry[field] ? entry[field] : entry).Mark();
    }
    return YAML::Mark::null_mark();
  }

  Source source_;
  std::vector<std::string>& problems_;
  PanelFile panel_;
};

}  // namespace

Keys keys(PanelLayout& layout) {
  return {key("plate.min_m", "m", -2, 2, &layout.plate_min_m,
              "lower left corner of the plate as the robot sees it, [right, up] from the panel's origin"),
          key("plate.max_m", "m", -2, 2, &layout.plate_max_m, "upper right corner"),
          key("plate.thickness_m", "m", 0.002, 0.2, &layout.plate_thickness_m, "its thickness")};
}

Keys keys(ValveEntry& valve) {
  PanelLayout::Valve& v = valve.layout;
  ValveNature& n = valve.nature;
  return {
      key("name", "", 0, 0, &valve.name, "what tasks and messages call it"),
      key("at_m", "m", -2, 2, &v.at_m, "its axis, [right, up] from the panel's origin"),
      key("kind", "", 0, 0, &valve.kind,
          "what its handle is: a bar on a stem, a flat bar on a stem, or a bar on two posts. It sets the usual sizes",
          {"t_bar", "d_handle", "fishtail", "paddle"}),
      key("length_m", "m", 0.06, 0.16, &v.handle_length_m,
          "length of its bar: longer than the pads are wide, and of a D-handle by its two posts"),
      key("thickness_m", "m", 0.008, 0.05, &v.handle_thickness_m, "its thickness"),
      key("depth_m", "m", 0, 0.05, &valve.depth_m, "how deep a flat bar is, along the valve's axis; 0: as its thickness"),
      key("height_m", "m", 0.05, 0.13, &v.handle_height_m, "its centre line's height over the panel"),
      key("pointer", "", 0, 0, &v.pointer,
          "the mark at that end of the bar which points up at 0 degrees; without one a bar looks the same after half a turn",
          {pointer_words.begin(), pointer_words.end()}),
      key("pointer_length_m", "m", 0.015, 0.06, &v.pointer_length_m, "how much of the bar the mark covers, from its end"),
      key("stop_min_deg", "deg", -180, 180, &valve.stops.stop_min_deg, "end stop of the handle, clockwise; 0 is a vertical bar"),
      key("stop_max_deg", "deg", -180, 180, &valve.stops.stop_max_deg, "end stop, counter-clockwise; at most 350 degrees from the other"),
      key("torque_nm", "N m", 0, 100'000, &n.torque_nm,
          "the most that it takes to turn, as its maker says: more than the arm gives is refused"),
      key("friction_nm", "N m", 0, 20, &n.friction_nm, "in simulation: what it takes; no more than torque_nm"),
      key("start_deg", "deg", -180, 180, &n.start_deg, "in simulation: the handle's angle at the start"),
      key("detents_deg", "deg", -360, 360, &n.detents_deg, "in simulation: the named positions, in which the handle settles"),
      key("detent_nm", "N m", 0, 6, &n.detent_nm, "in simulation: peak pull toward a detent"),
      key("viscous_nm_s", "N m s/rad", 0, 20, &n.viscous_nm_s, "in simulation: viscous friction of the handle")};
}

Keys keys(ButtonEntry& button) {
  PanelLayout::Button& b = button.layout;
  return {key("name", "", 0, 0, &button.name, "what tasks and messages call it"),
          key("at_m", "m", -2, 2, &b.at_m, "its middle, [right, up] from the panel's origin"),
          key("width_m", "m", 0.005, 0.06, &b.width_m, "diameter of its cap"),
          key("height_m", "m", 0.005, 0.07, &b.height_m, "its height over the panel"),
          key("stroke_m", "m", 0.001, 0.02, &b.stroke_m, "how far it goes in")};
}

Keys keys(PanelLayout::Marker& marker) {
  return {key("id", "", 0, 586, &marker.id, "of the AprilTag 36h11; messages call the marker by it"),
          key("at_m", "m", -2, 2, &marker.centre_m, "its centre, [right, up] from the panel's origin"),
          key("size_m", "m", 0.02, 0.16, &marker.size_m, "side of its black square"),
          key("plate_m", "m", 0.02, 0.2, &marker.plate_m, "side of its plate")};
}

PanelFile read_panel_file(const fs::path& file) {
  std::vector<std::string> problems;
  Reader reader(file, problems);
  const YAML::Node root = parse_yaml(read_text_file(file), reader.source());
  PanelFile panel;
  reader.attempt([&] { panel = reader.read(root); });
  if (!problems.empty()) throw InputError(joined(problems));
  return panel;
}

bool settle_panel(const std::string& told_in, const std::string& file, const DockedPanel& docked, const ValveStops& stops,
                  PanelLayout& layout, PanelSurvey& survey, std::vector<std::string>& problems) {
  if (file.empty()) {
    layout = layout_of(docked, stops);
    survey = {};
    return true;
  }
  DockedPanel given = docked, usual;
  ValveStops given_stops = stops, usual_stops;
  usual.nominal_x_m = docked.nominal_x_m;
  usual.nominal_y_m = docked.nominal_y_m;
  usual.nominal_z_m = docked.nominal_z_m;
  std::string none;
  Keys told, defaults;
  add_panel(told, none, given);
  add_panel(defaults, none, usual);
  add_valve_stops(told, given_stops);
  add_valve_stops(defaults, usual_stops);
  for (std::size_t i = 0; i < told.size(); ++i) {
    if (value_text(told[i]) == value_text(defaults[i])) continue;
    problems.push_back(told_in + ": '" + told[i].path + "' is of the docked mission's panel: 'panel.file' says what is on this one");
  }
  survey = {};
  bool read = true;
  try {
    PanelFile panel = read_panel_file(named_panel(told_in, file));
    layout = panel.layout;
    survey = panel.survey;
  } catch (const InputError& problem) {
    problems.emplace_back(problem.what());
    read = false;
  }
  layout.nominal_x_m = docked.nominal_x_m;
  layout.nominal_y_m = docked.nominal_y_m;
  layout.nominal_z_m = docked.nominal_z_m;
  return read;
}

std::string panel_named_in(const YAML::Node& root) {
  const auto text = [](const YAML::Node& node) { return node && node.IsScalar() ? node.Scalar() : std::string(); };
  if (!root.IsMap()) return "";
  const YAML::Node group = root["panel"];
  const std::string within = group && group.IsMap() ? text(group["file"]) : "";
  return within.empty() ? text(root["panel.file"]) : within;
}

std::string panel_file_of(const std::string& name) {
  const bool file = name.find('/') != std::string::npos || name.ends_with(".yaml") || name.ends_with(".yml");
  return file || name.empty() ? name : "panels/" + name + ".yaml";
}

std::vector<std::string> shipped_panels() { return shipped_in("panels"); }

std::string panel_schema() {
  using Json = nlohmann::ordered_json;
  PanelLayout layout;
  ValveEntry valve;
  ButtonEntry button;
  PanelLayout::Marker marker;
  Json schema = Json::parse(key_schema(keys(layout), "Lanternfish panel"));
  Json& properties = schema["properties"];
  const auto list = [&](const char* name, const Keys& item, const std::vector<std::string>& required, std::size_t most) {
    const Json of = Json::parse(list_file_schema(name, item, required, version, ""));
    properties[name] = of["properties"][name];
    properties[name]["maxItems"] = most;
  };
  properties["version"] = {{"const", version}};
  list("valves", keys(valve), {"name", "at_m"}, PanelLayout::max_valves);
  list("buttons", keys(button), {"name", "at_m"}, PanelLayout::max_buttons);
  list("markers", keys(marker), {"id", "at_m"}, PanelLayout::max_markers);
  properties["markers"]["minItems"] = 1;
  schema["required"] = {"version", "markers"};
  return schema.dump(2) + "\n";
}

std::string panel_keys_markdown() {
  PanelLayout layout;
  ValveEntry valve;
  ButtonEntry button;
  PanelLayout::Marker marker;
  std::string out = markdown_head;
  for (const Key& key : keys(layout)) out += markdown_row(key);
  for (const Key& key : keys(valve)) out += markdown_row(key, "valves[].");
  for (const Key& key : keys(button)) out += markdown_row(key, "buttons[].");
  for (const Key& key : keys(marker)) out += markdown_row(key, "markers[].");
  return out;
}

}  // namespace lf::config
