#include "hal/config/key_text.hpp"

#include <charconv>
#include <concepts>
#include <nlohmann/json.hpp>

namespace lf::config {

std::string number_text(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

namespace {

// A text that YAML reads back as it is.
std::string quoted(const std::string& text) { return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace); }

template <class List, class Text>
std::string flow_list(const List& list, Text text) {
  std::string out = "[";
  for (const auto& item : list) out += (out.size() > 1 ? ", " : "") + text(item);
  return out + "]";
}

// A key's value as YAML in one line.
struct FlowYaml {
  std::string operator()(const double* value) const { return number_text(*value); }
  template <std::integral Integer>
  std::string operator()(const Integer* value) const {
    return std::to_string(*value);
  }
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const std::string* value) const { return quoted(*value); }
  std::string operator()(const Spread* value) const {
    if (value->min == value->max) return number_text(value->min);
    return std::string("{min: ") + number_text(value->min) + ", max: " + number_text(value->max) + "}";
  }
  std::string operator()(const Chance* value) const {
    return *value == Chance::either ? "either" : *value == Chance::yes ? "true" : "false";
  }
  std::string operator()(const PanelLayout::Pointer* value) const { return pointer_words[static_cast<std::size_t>(*value)]; }
  std::string operator()(const std::array<double, 3>* value) const { return flow_list(*value, number_text); }
  std::string operator()(const Vec2* value) const {
    return std::string("[") + number_text(value->x()) + ", " + number_text(value->y()) + "]";
  }
  std::string operator()(const std::array<Vec2, 3>* value) const {
    return flow_list(*value, [this](const Vec2& point) { return (*this)(&point); });
  }
  std::string operator()(const std::vector<double>* value) const { return flow_list(*value, number_text); }
  template <std::size_t Count>
  std::string operator()(const std::vector<std::array<double, Count>>* value) const {
    return flow_list(*value, [](const std::array<double, Count>& item) { return flow_list(item, number_text); });
  }
  std::string operator()(const std::vector<std::string>* value) const {
    return flow_list(*value, [](const std::string& text) { return text; });
  }
  std::string operator()(const std::vector<Task>* value) const {
    return flow_list(*value, [this](const Task& task) {
      if (task.kind == Task::Kind::turn_valve)
        return "{turn_valve: {" + (task.valve.empty() ? "" : "valve: " + task.valve + ", ") + "to_deg: " + number_text(task.to_deg) + "}}";
      return std::string("{press_buttons: {order: ") + (*this)(&task.order) + "}}";
    });
  }
  std::string operator()(const std::vector<Fault>* value) const {
    return flow_list(*value, [](Fault fault) {
      std::string out = "{";
      for (const Key& key : keys(fault)) {
        const bool by_step = !fault.at_step.empty();
        if ((key.path == "node" && fault.node.empty()) || (key.path == "at_s" && by_step)) continue;
        if ((key.path == "at_step" || key.path == "after_s") && !by_step) continue;
        out += (out.size() > 1 ? ", " : "") + key.path + ": " + std::visit(FlowYaml{}, key.value);
      }
      return out + "}";
    });
  }
};

}  // namespace

std::string value_text(const Key& key) { return std::visit(FlowYaml{}, key.value); }

std::string markdown_row(const Key& key, const std::string& prefix, bool with_default) {
  const bool has_range = key.min < key.max;
  const std::string range =
      has_range ? number_text(key.min) + " to " + number_text(key.max) + (key.unit.empty() ? "" : " " + key.unit) : "";
  return "| `" + prefix + key.path + "` | " + type_name(key) + " | " + (with_default ? "`" + value_text(key) + "`" : "") + " | " + range +
         " | " + key.doc + " |\n";
}

}  // namespace lf::config
