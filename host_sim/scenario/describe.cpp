#include "host_sim/scenario/describe.hpp"

#include <algorithm>
#include <charconv>
#include <concepts>
#include <nlohmann/json.hpp>

#include "host_sim/scenario/keys.hpp"

namespace lf::scenario {

namespace {

using Json = nlohmann::ordered_json;

// The shortest text that reads back to the same number.
std::string text_of(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// A text that YAML reads back as it is.
std::string quoted(const std::string& text) { return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace); }

template <class List, class Text>
std::string flow_list(const List& list, Text text) {
  std::string out = "[";
  for (const auto& item : list) out += (out.size() > 1 ? ", " : "") + text(item);
  return out + "]";
}

// A key's value as YAML in one line.
struct FlowYaml {
  std::string operator()(const double* value) const { return text_of(*value); }
  template <std::integral Integer>
  std::string operator()(const Integer* value) const {
    return std::to_string(*value);
  }
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const std::string* value) const { return quoted(*value); }
  std::string operator()(const Spread* value) const {
    if (value->min == value->max) return text_of(value->min);
    return std::string("{min: ") + text_of(value->min) + ", max: " + text_of(value->max) + "}";
  }
  std::string operator()(const Chance* value) const {
    return *value == Chance::either ? "either" : *value == Chance::yes ? "true" : "false";
  }
  std::string operator()(const PanelLayout::Pointer* value) const { return config::pointer_words[static_cast<std::size_t>(*value)]; }
  std::string operator()(const std::array<double, 3>* value) const { return flow_list(*value, text_of); }
  std::string operator()(const Vec2* value) const { return std::string("[") + text_of(value->x()) + ", " + text_of(value->y()) + "]"; }
  std::string operator()(const std::array<Vec2, 3>* value) const {
    return flow_list(*value, [this](const Vec2& point) { return (*this)(&point); });
  }
  std::string operator()(const std::vector<double>* value) const { return flow_list(*value, text_of); }
  template <std::size_t Count>
  std::string operator()(const std::vector<std::array<double, Count>>* value) const {
    return flow_list(*value, [](const std::array<double, Count>& item) { return flow_list(item, text_of); });
  }
  std::string operator()(const std::vector<std::string>* value) const {
    return flow_list(*value, [](const std::string& text) { return text; });
  }
  std::string operator()(const std::vector<Task>* value) const {
    return flow_list(*value, [this](const Task& task) {
      if (task.kind == Task::Kind::turn_valve) return std::string("{turn_valve: {to_deg: ") + text_of(task.to_deg) + "}}";
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

Json nested_schema(const std::vector<Key>& table);

Json number_schema(const Key& key, const char* type) { return {{"type", type}, {"minimum", key.min}, {"maximum", key.max}}; }

Json words_schema(const Key& key) {
  Json schema{{"type", "string"}};
  if (!key.words.empty()) schema["enum"] = key.words;
  return schema;
}

Json list_schema(const Json& items, std::size_t count) {
  Json schema{{"type", "array"}, {"items", items}};
  if (count > 0) schema["minItems"] = schema["maxItems"] = count;
  return schema;
}

struct TypeSchema {
  const Key& key;

  Json operator()(double*) const { return number_schema(key, "number"); }
  template <std::integral Integer>
  Json operator()(Integer*) const {
    return number_schema(key, "integer");
  }
  Json operator()(bool*) const { return {{"type", "boolean"}}; }
  Json operator()(std::string*) const { return words_schema(key); }
  Json operator()(Spread*) const {
    const Json number = number_schema(key, "number");
    const Json range{{"type", "object"},
                     {"properties", {{"min", number}, {"max", number}}},
                     {"required", {"min", "max"}},
                     {"additionalProperties", false}};
    return {{"oneOf", {number, range}}};
  }
  Json operator()(Chance*) const { return {{"enum", Json::array({true, false, "either"})}}; }
  Json operator()(PanelLayout::Pointer*) const { return words_schema(key); }
  Json operator()(std::array<double, 3>*) const { return list_schema(number_schema(key, "number"), 3); }
  Json operator()(Vec2*) const { return list_schema(number_schema(key, "number"), 2); }
  Json operator()(std::array<Vec2, 3>*) const { return list_schema((*this)(static_cast<Vec2*>(nullptr)), 3); }
  Json operator()(std::vector<double>*) const { return list_schema(number_schema(key, "number"), 0); }
  template <std::size_t Count>
  Json operator()(std::vector<std::array<double, Count>>*) const {
    return list_schema(list_schema(number_schema(key, "number"), Count), 0);
  }
  Json operator()(std::vector<std::string>*) const { return list_schema(words_schema(key), 0); }
  Json operator()(std::vector<Task>*) const {
    Task task;
    Json item = nested_schema(keys(task));
    item["minProperties"] = item["maxProperties"] = 1;
    return list_schema(item, 0);
  }
  Json operator()(std::vector<Fault>*) const {
    Fault fault;
    Json item = nested_schema(keys(fault));
    item["required"] = {"kind"};
    return list_schema(item, 0);
  }
};

// The table's dotted paths as nested objects.
Json nested_schema(const std::vector<Key>& table) {
  Json root{{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
  for (const Key& key : table) {
    Json* object = &root;
    std::size_t begin = 0;
    for (std::size_t dot = key.path.find('.'); dot != std::string::npos; dot = key.path.find('.', begin)) {
      Json& section = (*object)["properties"][key.path.substr(begin, dot - begin)];
      if (section.is_null())
        section = Json{{"type", Json::array({"object", "null"})}, {"additionalProperties", false}, {"properties", Json::object()}};
      object = &section;
      begin = dot + 1;
    }
    Json schema = std::visit(TypeSchema{key}, key.value);
    schema["description"] = key.doc + (key.unit.empty() ? "" : " [" + key.unit + "]");
    (*object)["properties"][key.path.substr(begin)] = schema;
  }
  return root;
}

bool has_range(const Key& key) { return key.min < key.max; }

void add_rows(std::string& out, const std::vector<Key>& table, const std::string& prefix, bool with_default) {
  for (const Key& key : table) {
    const std::string shown = std::visit(FlowYaml{}, key.value);
    const std::string range = has_range(key) ? text_of(key.min) + " to " + text_of(key.max) + (key.unit.empty() ? "" : " " + key.unit) : "";
    out += "| `" + prefix + key.path + "` | " + type_name(key) + " | " + (with_default ? "`" + shown + "`" : "") + " | " + range + " | " +
           key.doc + " |\n";
  }
}

}  // namespace

std::string json_schema() {
  Scenario scenario;
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Lanternfish scenario"}};
  schema.update(nested_schema(keys(scenario)));
  return schema.dump(2) + "\n";
}

std::string keys_markdown() {
  Scenario scenario;
  Task task;
  Fault fault;
  std::string out = "| key | takes | default | range | meaning |\n|---|---|---|---|---|\n";
  add_rows(out, keys(scenario), "", true);
  add_rows(out, keys(task), "tasks[].", false);
  add_rows(out, keys(fault), "faults[].", false);
  return out;
}

std::string scenario_yaml(const Scenario& of) {
  Scenario scenario = of;
  std::string out, section;
  for (const Key& key : keys(scenario)) {
    const std::size_t dot = key.path.find('.');
    const std::string group = dot == std::string::npos ? "" : key.path.substr(0, dot);
    if (group != section && !group.empty()) out += group + ":\n";
    section = group;
    const std::string line =
        (group.empty() ? "" : "  ") + key.path.substr(group.empty() ? 0 : dot + 1) + ": " + std::visit(FlowYaml{}, key.value);
    out += line + std::string(line.size() < 44 ? 44 - line.size() : 1, ' ') + "# " + key.doc + (key.unit.empty() ? "" : ", " + key.unit) +
           "\n";
  }
  return out;
}

}  // namespace lf::scenario
