#include "hal/config/key_schema.hpp"

#include <concepts>
#include <nlohmann/json.hpp>

namespace lf::config {

namespace {

using Json = nlohmann::ordered_json;

Json nested_schema(const std::vector<Key>& table);

// Of an arm whose joints no schema knows.
constexpr const char* joint_name = "^[A-Za-z][A-Za-z0-9_-]*$";

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
    Json item = nested_schema(keys(task, {}));  // names are a panel file's
    item["minProperties"] = item["maxProperties"] = 1;
    return list_schema(item, 0);
  }
  Json operator()(std::vector<Fault>*) const {
    Fault fault;
    Json item = nested_schema(keys(fault));
    Json& node = item["properties"]["node"];
    node["anyOf"] = Json::array({{{"enum", node["enum"]}}, {{"pattern", joint_name}}});
    node.erase("enum");
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

// Another arm's drives stand there by the names of its own joints, with the keys of any drive.
void take_any_joint(Json& root) {
  Json& groups = root["properties"];
  if (!groups.contains("drives")) return;
  Json& drives = groups["drives"];
  for (const auto& [name, drive] : drives["properties"].items()) {
    if (drive.contains("properties")) {
      drives["additionalProperties"] = drive;
      return;
    }
  }
}

}  // namespace

std::string key_schema(const Keys& table, const std::string& title) {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  schema.update(nested_schema(table));
  take_any_joint(schema);
  return schema.dump(2) + "\n";
}

std::string list_file_schema(const std::string& list, const Keys& item, const std::vector<std::string>& required, std::int64_t version,
                             const std::string& title) {
  Json items = nested_schema(item);
  items["required"] = required;
  const Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                    {"title", title},
                    {"type", "object"},
                    {"additionalProperties", false},
                    {"properties", {{"version", {{"const", version}}}, {list, list_schema(items, 0)}}},
                    {"required", {"version"}}};
  return schema.dump(2) + "\n";
}

}  // namespace lf::config
