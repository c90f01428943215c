#include "hal/config/key.hpp"

#include "firmware/mission/steps.hpp"
#include "hal/config/fault_kinds.hpp"

namespace lf::config {

namespace {

// The alternatives of KeyValue, in their order.
struct TypeName {
  const Key& key;
  std::string operator()(double*) const { return "a number"; }
  std::string operator()(std::int64_t*) const { return "a whole number"; }
  std::string operator()(std::int32_t*) const { return "a whole number"; }
  std::string operator()(std::uint32_t*) const { return "a whole number"; }
  std::string operator()(bool*) const { return "true or false"; }
  std::string operator()(std::string*) const { return key.words.empty() ? "text" : "one of " + words(); }
  std::string operator()(Spread*) const { return "a number or {min: , max: }"; }
  std::string operator()(Chance*) const { return "true, false or either"; }
  std::string operator()(PanelLayout::Pointer*) const { return "one of " + words(); }
  std::string operator()(std::array<double, 3>*) const { return "a list of 3 numbers"; }
  std::string operator()(Vec2*) const { return "a list of 2 numbers"; }
  std::string operator()(std::array<Vec2, 3>*) const { return "a list of 3 lists of 2 numbers"; }
  std::string operator()(std::vector<double>*) const { return "a list of numbers"; }
  template <std::size_t Count>
  std::string operator()(std::vector<std::array<double, Count>>*) const {
    return "a list of lists of " + std::to_string(Count) + " numbers";
  }
  std::string operator()(std::vector<std::string>*) const { return key.words.empty() ? "a list of texts" : "a list of " + words(); }
  std::string operator()(std::vector<Task>*) const { return "a list of tasks"; }
  std::string operator()(std::vector<Fault>*) const { return "a list of faults"; }
  std::string words() const {
    std::string list;
    for (std::size_t i = 0; i < key.words.size(); ++i) list += (i == 0 ? "" : i + 1 == key.words.size() ? " or " : ", ") + key.words[i];
    return list;
  }
};

std::vector<std::string> step_names() {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < mission::step_count; ++i) names.emplace_back(mission::row(static_cast<mission::Step>(i)).name);
  return names;
}

}  // namespace

Key key(std::string path, std::string unit, double min, double max, KeyValue value, std::string doc, std::vector<std::string> words) {
  return {std::move(path), std::move(doc), std::move(unit), min, max, value, std::move(words)};
}

Keys keys(Task& task, const std::vector<std::string>& buttons) {
  return {key("turn_valve.valve", "", 0, 0, &task.valve, "which valve of the panel, by its name; empty: the only one"),
          key("turn_valve.to_deg", "deg", -180, 180, &task.to_deg, "turn the handle to this angle"),
          key("press_buttons.order", "", 0, 0, &task.order,
              "press these buttons, one after the other, by their names: left, centre and right on the docked mission's panel", buttons)};
}

Keys keys(Fault& fault, const JointNames& joints) {
  return {key("at_s", "s", 0, 7200, &fault.at_s, "when it happens, from power-on"),
          key("at_step", "", 0, 0, &fault.at_step, "in place of at_s: when the mission first enters this step", step_names()),
          key("after_s", "s", 0, 7200, &fault.after_s, "how long after at_step began"),
          key("kind", "", 0, 0, &fault.kind, "what happens: see the table of faults", fault_kind_names()),
          key("node", "", 0, 0, &fault.node, "to which node, where the kind is a node's", fault_nodes(FaultPlace::node_or_master, joints)),
          key("duration_s", "s", 0, 7200, &fault.duration_s, "how long; 0 for the rest of the run"),
          key("can_id", "", 0, 0x7FF, &fault.can_id, "drop_frames: the identifier whose frames are lost")};
}

std::string type_name(const Key& key) { return std::visit(TypeName{key}, key.value); }

}  // namespace lf::config
