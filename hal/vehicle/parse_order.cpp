#include "hal/vehicle/parse_order.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "hal/config/homing_file.hpp"
#include "hal/config/machine.hpp"
#include "hal/config/nearest.hpp"
#include "shared/input_error.hpp"

namespace lf::hal {

namespace {

using Value = nlohmann::json;

// A job, {"tasks": [{"press_buttons": {"order": []}}]}, has five. More would let a line of brackets fill the stack of who writes it down again.
constexpr int deepest = 8;
constexpr std::size_t longest_quote = 40;  // letters of the operator's own text in a message
constexpr double largest_turn_deg = 180;   // as the key tasks[].turn_valve.to_deg has it

// Thrown and caught within this file.
struct Wrong {
  std::string why;
};

[[noreturn]] void refuse(std::string why) { throw Wrong{std::move(why)}; }

bool nested_too_deep(std::string_view line) {
  int depth = 0;
  for (const char c : line) {
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (depth > deepest) return true;
  }
  return false;
}

// Texts of a parsed line are valid UTF-8; a letter that a cut would split is left out whole.
std::string quoted(const std::string& text) {
  std::string shown;
  for (const char c : text) {
    const bool goes_on = (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
    if (shown.size() >= longest_quote && !goes_on) return "'" + shown + "...'";
    shown += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return "'" + shown + "'";
}

// "do" is in every request.
std::string takes(std::initializer_list<const char*> names) {
  std::string list;
  for (const char* name : names) {
    if (std::string_view(name) != "do") list += (list.empty() ? ": it takes \"" : ", \"") + std::string(name) + "\"";
  }
  return list.empty() ? ": it takes nothing but \"do\"" : list;
}

// Of a name that is short enough to be a misspelt one.
std::string nearest_request(const std::string& name) {
  if (name.size() > longest_quote) return "";
  std::vector<std::string> known;
  for (const Right& right : operator_rights()) known.emplace_back(right.request);
  return config::suggestion(name, known);
}

void allow_only(const Value& object, const char* what, std::initializer_list<const char*> names) {
  for (const auto& [member, value] : object.items()) {
    bool known = false;
    for (const char* name : names) known = known || member == name;
    if (!known) refuse(std::string(what) + " takes no " + quoted(member) + takes(names));
  }
}

// Null where `parent` is no object or has no such member.
const Value& member(const Value& parent, const char* name) {
  static const Value none;
  if (!parent.is_object()) return none;
  const auto found = parent.find(name);
  return found == parent.end() ? none : *found;
}

std::optional<Command> command_of(const std::string& request) {
  if (request == "start") return Command::start;
  if (request == "home") return Command::home;
  if (request == "hold") return Command::hold;
  if (request == "resume") return Command::resume;
  if (request == "abort") return Command::abort;
  if (request == "reset") return Command::reset;
  if (request == "jog") return Command::jog;
  if (request == "task") return Command::set_tasks;
  if (request == "estop") return Command::emergency_stop;
  return std::nullopt;
}

// "left, centre or right"
std::string listed(const std::vector<std::string>& names, const char* last = " or ") {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) text += (i == 0 ? "" : i + 1 == names.size() ? last : ", ") + names[i];
  return names.empty() ? "none" : text;
}

std::size_t joint_of(const Value& name, const JointNames& joints) {
  if (const std::optional<std::size_t> joint = joints.find(name.get_ref<const std::string&>())) return *joint;
  refuse("no joint " + quoted(name.get<std::string>()) + ": " + listed({joints.begin(), joints.end()}));
}

void read_jog(const Value& request, const JointNames& joints, mission::Order& order) {
  allow_only(request, "jog", {"do", "joint", "by_deg"});
  const Value& joint = member(request, "joint");
  const Value& by = member(request, "by_deg");
  if (!joint.is_string() || !by.is_number()) refuse("jog takes \"joint\" and \"by_deg\"");
  order.joint = joint_of(joint, joints);
  order.by_rad = rad_from_deg(by.get<double>());
  if (!std::isfinite(order.by_rad) || std::abs(order.by_rad) > mission::largest_jog_rad) refuse("a jog is of 20 deg at most");
}

config::Task read_turn(const Value& turn, const PanelNames& names) {
  const Value& to = member(turn, "to_deg");
  const Value& valve = member(turn, "valve");
  if (!to.is_number() || (!valve.is_null() && !valve.is_string()))
    refuse("turn_valve takes {\"to_deg\": DEGREES}, and {\"valve\": NAME} where the panel has several");
  allow_only(turn, "turn_valve", {"to_deg", "valve"});
  config::Task task;
  if (valve.is_string()) task.valve = valve.get<std::string>();
  task.kind = config::Task::Kind::turn_valve;
  if (const std::string& name = task.valve; !config::find_valve(names, name)) {
    const std::string has = listed(names.valves);
    refuse(name.empty() ? "\"valve\" is missing: the panel has " + has : "no valve " + quoted(name) + ": " + has);
  }
  task.to_deg = to.get<double>();
  if (!(std::abs(task.to_deg) <= largest_turn_deg)) refuse("\"to_deg\" is from -180 to 180");
  return task;
}

config::Task read_presses(const Value& presses, const PanelNames& names) {
  const Value& buttons = member(presses, "order");
  if (!buttons.is_array() || buttons.empty())
    refuse("press_buttons takes {\"order\": [" + listed(names.buttons, ", ") + "]}, one or more of them");
  allow_only(presses, "press_buttons", {"order"});
  config::Task task;
  task.kind = config::Task::Kind::press_buttons;
  task.order.clear();
  for (const Value& button : buttons) {
    const std::string name = button.is_string() ? button.get<std::string>() : "";
    if (!config::find_button(names, name)) refuse("no button " + quoted(name) + ": " + listed(names.buttons));
    task.order.push_back(name);
  }
  return task;
}

config::Task read_task(const Value& task, const PanelNames& names) {
  const bool turn = task.is_object() && task.size() == 1 && task.contains("turn_valve");
  const bool press = task.is_object() && task.size() == 1 && task.contains("press_buttons");
  if (!turn && !press)
    refuse("a task is {\"turn_valve\": {\"to_deg\": N}} or {\"press_buttons\": {\"order\": [" + listed(names.buttons, ", ") + "]}}");
  return turn ? read_turn(task["turn_valve"], names) : read_presses(task["press_buttons"], names);
}

void read_tasks(const Value& request, const PanelNames& names, mission::Order& order) {
  allow_only(request, "task", {"do", "tasks"});
  const Value& list = member(request, "tasks");
  if (!list.is_array()) refuse("task takes \"tasks\", a list");
  std::vector<config::Task> tasks;
  for (const Value& task : list) tasks.push_back(read_task(task, names));
  try {
    order.tasks = config::core_tasks(tasks, names, "task");
  } catch (const InputError& error) {
    refuse(error.what());
  }
}

bool flag(const Value& request, const char* name) {
  const Value& value = member(request, name);
  if (!value.is_null() && !value.is_boolean()) refuse("\"" + std::string(name) + "\" is true or false");
  return value.is_boolean() && value.get<bool>();
}

void read_joints(const Value& joints, const JointNames& names, CommissionOrder& order) {
  if (joints.is_null()) return;
  if (!joints.is_array() || joints.empty()) refuse("\"joints\" is a list of joints, one or more");
  order.joints = {};
  for (const Value& joint : joints) {
    if (!joint.is_string()) refuse("\"joints\" is a list of joints, one or more");
    order.joints[joint_of(joint, names)] = true;
  }
}

void read_commission(const Value& request, const JointNames& names, CommissionOrder& order) {
  allow_only(request, "commission", {"do", "joints", "here", "clear", "moved"});
  order.here = flag(request, "here");
  if (!order.here && !flag(request, "clear"))
    refuse("commissioning moves the arm against its stops: clear its reach, then say so with \"clear\": true (--clear)");
  read_joints(member(request, "joints"), names, order);
  order.moved = flag(request, "moved");
  if (order.moved && std::count(order.joints.begin(), order.joints.end(), true) != 1)
    refuse("\"moved\" (--moved) says that a joint's encoder or stop was changed: commission this joint alone, with \"joints\" (--joint)");
}

OperatorRequest read_request(std::string_view line, const PanelNames& names, const JointNames& joints) {
  if (nested_too_deep(line)) refuse("nested too deep: a request is a JSON object such as {\"do\": \"status\"}");
  const Value request = Value::parse(line, nullptr, false);
  const Value& what = member(request, "do");
  if (!what.is_string()) refuse("a request is a JSON object such as {\"do\": \"status\"}");
  const auto& name = what.get_ref<const std::string&>();
  OperatorRequest read;
  read.right = right_of(name);
  if (read.right == nullptr) refuse("no request " + quoted(name) + nearest_request(name));
  const std::optional<Command> command = command_of(name);
  read.for_the_core = command.has_value();
  if (command) read.order.command = *command;
  if (command == Command::jog) {
    read_jog(request, joints, read.order);
  } else if (command == Command::set_tasks) {
    read_tasks(request, names, read.order);
  } else if (name == "commission") {
    read_commission(request, joints, read.commission);
  } else {
    allow_only(request, read.right->request, {"do"});
  }
  return read;
}

}  // namespace

ParsedOrder parse_order(std::string_view line, const PanelNames& names, const JointNames& joints) {
  try {
    return read_request(line, names, joints);
  } catch (const Wrong& wrong) {
    return wrong.why;
  } catch (const std::exception& error) {  // of the JSON library: no path to it is known
    return std::string("a request that cannot be read: ") + error.what();
  }
}

}  // namespace lf::hal
