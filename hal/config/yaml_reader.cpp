#include "hal/config/yaml_reader.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <concepts>
#include <optional>
#include <set>
#include <sstream>

#include "hal/config/fault_kinds.hpp"
#include "hal/config/nearest.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

namespace {

std::string number_text(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  return std::string(text, end.ptr);
}

std::string last_name(const std::string& path) { return path.substr(path.rfind('.') + 1); }

// The first name of `path` after `prefix`.
std::string next_name(const std::string& path, const std::string& prefix) {
  const std::size_t dot = path.find('.', prefix.size());
  return path.substr(prefix.size(), dot == std::string::npos ? dot : dot - prefix.size());
}

// "text 'abc'", "a list": what stands there instead of what should.
std::string shape_of(const YAML::Node& node) {
  if (!node.IsDefined() || node.IsNull()) return "nothing";
  if (node.IsSequence()) return "a list";
  if (node.IsMap()) return "a group of keys";
  return "'" + node.Scalar() + "'";
}

class ValueReader {
 public:
  ValueReader(const YAML::Node& node, const std::string& path, const Key& key, const Source& source)
      : node_(node), path_(path), key_(key), source_(source) {}

  void operator()(double* value) const { *value = number(node_); }
  template <std::integral Integer>
  void operator()(Integer* value) const {
    const double read = is_hexadecimal(node_) ? hexadecimal(node_) : number(node_);
    if (read != std::floor(read)) wrong_type(node_);
    *value = static_cast<Integer>(read);
  }
  void operator()(bool* value) const {
    if (!node_.IsScalar() || !YAML::convert<bool>::decode(node_, *value)) wrong_type(node_);
  }
  void operator()(std::string* value) const { *value = text(node_); }
  void operator()(Spread* value) const;
  void operator()(Chance* value) const;
  void operator()(PanelLayout::Pointer* value) const {
    const auto word = std::find(pointer_words.begin(), pointer_words.end(), text(node_));
    *value = static_cast<PanelLayout::Pointer>(word - pointer_words.begin());
  }
  void operator()(std::array<double, 3>* value) const {
    const std::vector<double> read = numbers(node_, 3);
    std::copy(read.begin(), read.end(), value->begin());
  }
  void operator()(Vec2* value) const { *value = point(node_); }
  void operator()(std::array<Vec2, 3>* value) const {
    if (!node_.IsSequence() || node_.size() != value->size()) wrong_type(node_);
    for (std::size_t i = 0; i < value->size(); ++i) (*value)[i] = point(node_[i]);
  }
  void operator()(std::vector<double>* value) const { *value = numbers(node_, 0); }
  template <std::size_t Count>
  void operator()(std::vector<std::array<double, Count>>* value) const {
    if (!node_.IsSequence()) wrong_type(node_);
    value->clear();
    for (const YAML::Node& item : node_) {
      const std::vector<double> read = numbers(item, Count);
      for (std::size_t i = key_.above_zero_from; i < Count; ++i) {
        if (!(read[i] > 0))
          source_.refuse(item.Mark(), "'" + path_ + "' has " + number_text(read[i]) + " for the " + std::to_string(i + 1) + "th of these " +
                                          std::to_string(Count) + " numbers: it has to be above 0");
      }
      std::copy(read.begin(), read.end(), value->emplace_back().begin());
    }
  }
  void operator()(std::vector<std::string>* value) const;
  void operator()(std::vector<Task>* value) const;
  void operator()(std::vector<Fault>* value) const;

 private:
  [[noreturn]] void wrong_type(const YAML::Node& node) const {
    source_.refuse(node.Mark(), "'" + path_ + "' takes " + type_name(key_) + ", not " + shape_of(node));
  }

  double number(const YAML::Node& node) const;
  static bool is_hexadecimal(const YAML::Node& node) {
    return node.IsScalar() && node.Tag() != "!" && (node.Scalar().starts_with("0x") || node.Scalar().starts_with("0X"));
  }
  double hexadecimal(const YAML::Node& node) const;
  double in_range(const YAML::Node& node, double value) const;
  std::vector<double> numbers(const YAML::Node& node, std::size_t count) const;
  Vec2 point(const YAML::Node& node) const {
    const std::vector<double> read = numbers(node, 2);
    return {read[0], read[1]};
  }
  std::string text(const YAML::Node& node) const;
  Fault fault(const YAML::Node& item, const std::string& shown) const;

  const YAML::Node& node_;
  const std::string& path_;
  const Key& key_;
  const Source& source_;
};

double ValueReader::number(const YAML::Node& node) const {
  if (!node.IsScalar() || node.Tag() == "!") wrong_type(node);  // "!" is what a quoted text is tagged with
  std::string_view text = node.Scalar();
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool infinite = text.ends_with(".inf") || text.ends_with(".Inf") || text.ends_with(".INF");
  if (text == ".nan" || text == ".NaN" || text == ".NAN")
    value = std::nan("");
  else if (infinite || error == std::errc::result_out_of_range)
    value = INFINITY;
  else if (error != std::errc() || end != text.data() + text.size())
    wrong_type(node);
  if (!std::isfinite(value)) source_.refuse(node.Mark(), "'" + path_ + "' must be a finite number, not " + node.Scalar());
  return in_range(node, value);
}

// "0x182": CAN identifiers, nodes. One of more than 64 bits is out of every range.
double ValueReader::hexadecimal(const YAML::Node& node) const {
  const std::string_view digits = std::string_view(node.Scalar()).substr(2);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size()) wrong_type(node);
  return in_range(node, error == std::errc::result_out_of_range ? INFINITY : static_cast<double>(value));
}

double ValueReader::in_range(const YAML::Node& node, double value) const {
  if (value < key_.min || value > key_.max) {
    const std::string unit = key_.unit.empty() ? "" : " " + key_.unit;
    source_.refuse(node.Mark(), "'" + path_ + "' is " + node.Scalar() + ", out of its range " + number_text(key_.min) + " to " +
                                    number_text(key_.max) + unit);
  }
  return value;
}

// `count` 0: any number of them.
std::vector<double> ValueReader::numbers(const YAML::Node& node, std::size_t count) const {
  if (!node.IsSequence() || (count > 0 && node.size() != count)) wrong_type(node);
  std::vector<double> values;
  for (const YAML::Node& item : node) values.push_back(number(item));
  return values;
}

std::string ValueReader::text(const YAML::Node& node) const {
  if (!node.IsScalar()) wrong_type(node);
  const std::string& value = node.Scalar();
  if (value.find('\0') != std::string::npos) source_.refuse(node.Mark(), "'" + path_ + "' has a zero byte in it");
  if (key_.words.empty()) return value;
  for (const std::string& word : key_.words) {
    if (word == value) return value;
  }
  const std::string nearest = suggestion(value, key_.words);
  if (nearest.empty()) wrong_type(node);
  source_.refuse(node.Mark(), "'" + path_ + "' has no '" + value + "'" + nearest);
}

void ValueReader::operator()(Spread* value) const {
  if (node_.IsScalar()) {
    *value = Spread::fixed(number(node_));
    return;
  }
  if (!node_.IsMap()) wrong_type(node_);
  Spread read;
  const std::vector<Key> ends{{"min", "", key_.unit, key_.min, key_.max, &read.min}, {"max", "", key_.unit, key_.min, key_.max, &read.max}};
  read_map(node_, "", path_ + ".", ends, source_);
  if (!node_["min"] || !node_["max"]) source_.refuse(node_.Mark(), "'" + path_ + "' needs both min and max");
  if (read.min > read.max) source_.refuse(node_.Mark(), "'" + path_ + "' has its min above its max");
  *value = read;
}

void ValueReader::operator()(Chance* value) const {
  if (!node_.IsScalar()) wrong_type(node_);
  bool lit = false;
  if (node_.Scalar() == "either")
    *value = Chance::either;
  else if (YAML::convert<bool>::decode(node_, lit))
    *value = lit ? Chance::yes : Chance::no;
  else
    wrong_type(node_);
}

void ValueReader::operator()(std::vector<std::string>* value) const {
  if (!node_.IsSequence()) wrong_type(node_);
  value->clear();
  for (const YAML::Node& item : node_) value->push_back(text(item));
}

void ValueReader::operator()(std::vector<Task>* value) const {
  if (!node_.IsSequence()) wrong_type(node_);
  std::vector<Task> read;  // with a mistake in it, the key's value stays: no list is empty for that
  for (std::size_t i = 0; i < node_.size(); ++i) {
    const YAML::Node item = node_[i];
    const std::string shown = path_ + "[" + std::to_string(i) + "]";
    if (!item.IsMap() || item.size() != 1)
      source_.refuse(item.Mark(), "'" + shown + "' takes one task, turn_valve or press_buttons, not " + shape_of(item));
    Task task;
    const std::size_t told = source_.problems() != nullptr ? source_.problems()->size() : 0;
    read_map(item, "", shown + ".", keys(task, key_.names), source_);
    const bool complete = source_.problems() == nullptr || source_.problems()->size() == told;
    const YAML::Node turn = item["turn_valve"];
    task.kind = turn ? Task::Kind::turn_valve : Task::Kind::press_buttons;
    if (complete && turn && !(turn.IsMap() && turn["to_deg"]))
      source_.refuse(item.Mark(), "'" + shown + ".turn_valve.to_deg' is missing: to which angle?");
    if (complete && task.kind == Task::Kind::press_buttons && task.order.empty())
      source_.refuse(item.Mark(), "'" + shown + ".press_buttons.order' names no button");
    read.push_back(task);
  }
  *value = std::move(read);
}

// What is wrong between the keys of a fault: at which of them, and what. Nothing when it can happen.
std::optional<std::pair<const char*, std::string>> problem_of(const Fault& fault, bool timed, const JointNames& joints) {
  const FaultPlace place = find_fault_kind(fault.kind)->place;
  const std::vector<std::string> nodes = fault_nodes(place, joints);
  const bool right_node = std::find(nodes.begin(), nodes.end(), fault.node) != nodes.end();
  if (fault.node.empty() && !right_node) return {{"node", fault.kind + " needs a node"}};
  if (!right_node) return {{"node", fault.kind + (nodes.size() == 1 ? " takes no node" : " does not happen to " + fault.node)}};
  const bool frames = place == FaultPlace::frames;
  if (frames && fault.can_id == 0) return {{"can_id", fault.kind + " needs a can_id"}};
  if (!frames && fault.can_id != 0) return {{"can_id", fault.kind + " takes no can_id"}};
  if (!fault.at_step.empty() && fault.at_s != 0) return {{"at_s", fault.kind + " has both at_s and at_step"}};
  if (fault.at_step.empty() && fault.after_s != 0) return {{"after_s", fault.kind + " has after_s without at_step"}};
  const bool told = place == FaultPlace::told;
  if (told && (fault.at_s > 0 || !fault.at_step.empty())) return {{"kind", fault.kind + " is there from power-on or not at all"}};
  if (told && fault.duration_s > 0) return {{"duration_s", fault.kind + " takes no duration_s"}};
  if (!told && !timed) return {{"at_s", fault.kind + " needs a time: at_s, or at_step"}};
  return std::nullopt;
}

void ValueReader::operator()(std::vector<Fault>* value) const {
  if (!node_.IsSequence()) wrong_type(node_);
  value->clear();
  for (std::size_t i = 0; i < node_.size(); ++i) {
    try {
      value->push_back(fault(node_[i], path_ + "[" + std::to_string(i) + "]"));
    } catch (const InputError& problem) {
      if (source_.problems() == nullptr) throw;
      source_.problems()->emplace_back(problem.what());
    }
  }
}

Fault ValueReader::fault(const YAML::Node& item, const std::string& shown) const {
  if (!item.IsMap()) source_.refuse(item.Mark(), "'" + shown + "' takes a group of keys, not " + shape_of(item));
  Fault fault;
  const std::size_t told = source_.problems() != nullptr ? source_.problems()->size() : 0;
  const JointNames joints = key_.names.empty() ? JointNames() : JointNames(key_.names);
  read_map(item, "", shown + ".", keys(fault, joints), source_);
  const bool complete = source_.problems() == nullptr || source_.problems()->size() == told;
  if (!item["kind"]) source_.refuse(item.Mark(), "'" + shown + "' has no kind");
  if (const auto problem = problem_of(fault, item["at_s"] || item["at_step"], joints); complete && problem)
    source_.refuse(item.Mark(), "'" + shown + "." + problem->first + "': " + problem->second);
  return fault;
}

}  // namespace

void Source::refuse(const YAML::Mark& mark, const std::string& message) const {
  throw InputError(name_, has_lines_ && mark.line >= 0 ? mark.line + 1 : 0, message);
}

namespace {

// What of `line`, from `begin` on, is more than blanks and a comment.
bool says_something(const std::string& line, std::size_t begin) {
  const std::size_t first = line.find_first_not_of(" \t\r", begin);
  return first != std::string::npos && line[first] != '#';
}

// Where a second document begins, if one does. '---' and '...' at a line's start are markers everywhere, in texts as well (YAML 1.2, 9.1.2). The
// library's own LoadAll does not end on some damaged files.
std::optional<YAML::Mark> second_document(const std::string& text) {
  YAML::Mark mark;
  bool begun = false, ended = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line); ++mark.line) {
    const bool alone = line.size() == 3 || (line.size() > 3 && std::isspace(static_cast<unsigned char>(line[3])) != 0);
    if (alone && line.starts_with("...")) {
      ended = begun;
    } else if (alone && line.starts_with("---")) {
      if (begun) return mark;
      begun = says_something(line, 3);
    } else if (says_something(line, 0) && line[0] != '%') {
      if (ended) return mark;
      begun = true;
    }
  }
  return std::nullopt;
}

}  // namespace

YAML::Node parse_yaml(const std::string& text, const Source& source) {
  try {
    if (const std::optional<YAML::Mark> second = second_document(text))
      source.refuse(*second, "a second document begins here, and one is read: put all keys into the first");
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    source.refuse(error.mark, "not YAML: " + error.msg);
  }
}

std::string suggest_path(const std::string& path, const std::vector<Key>& table, const std::string& shown) {
  const std::string prefix = path.substr(0, path.rfind('.') == std::string::npos ? 0 : path.rfind('.') + 1);
  std::vector<std::string> here, elsewhere;
  for (const Key& key : table) {
    if (key.path.starts_with(prefix)) here.push_back(prefix + next_name(key.path, prefix));
    if (edit_distance(last_name(path), last_name(key.path), 1) <= 1) elsewhere.push_back(key.path);
  }
  std::vector<std::string> names;
  names.reserve(here.size());
  for (const std::string& candidate : here) names.push_back(last_name(candidate));
  if (const std::string* near = nearest(last_name(path), names)) return "; did you mean '" + shown + prefix + *near + "'?";
  if (!elsewhere.empty()) return "; did you mean '" + shown + elsewhere.front() + "'?";
  return "";
}

namespace {

// `seen`: of the whole document, since 'a: {b: 1}' and 'a.b: 1' are one key.
void read_entries(const YAML::Node& node, const std::string& prefix, const std::string& shown, const Keys& table, const Source& source,
                  std::set<std::string>& seen);

void read_entry(const YAML::Node& name, const YAML::Node& value, const std::string& path, const std::string& shown, const Keys& table,
                const Source& source, std::set<std::string>& seen) {
  const auto exact = std::find_if(table.begin(), table.end(), [&](const Key& key) { return key.path == path; });
  if (exact != table.end()) {
    if (value.IsNull()) source.refuse(name.Mark(), "'" + shown + path + "' takes " + type_name(*exact) + ", not nothing");
    return read_value(value, shown + path, *exact, source);
  }
  const bool section = std::any_of(table.begin(), table.end(), [&](const Key& key) { return key.path.starts_with(path + "."); });
  if (!section) source.refuse(name.Mark(), "unknown key '" + shown + path + "'" + suggest_path(path, table, shown));
  if (value.IsNull()) return;
  if (!value.IsMap()) source.refuse(value.Mark(), "'" + shown + path + "' takes a group of keys, not " + shape_of(value));
  read_entries(value, path + ".", shown, table, source, seen);
}

void read_entries(const YAML::Node& node, const std::string& prefix, const std::string& shown, const Keys& table, const Source& source,
                  std::set<std::string>& seen) {
  for (const auto& entry : node) {
    try {
      if (!entry.first.IsScalar()) source.refuse(entry.first.Mark(), "a key must be a word");
      const std::string path = prefix + entry.first.Scalar();
      if (!seen.insert(path).second) source.refuse(entry.first.Mark(), "'" + shown + path + "' is given twice");
      read_entry(entry.first, entry.second, path, shown, table, source, seen);
    } catch (const InputError& problem) {
      if (source.problems() == nullptr) throw;
      source.problems()->emplace_back(problem.what());
    }
  }
}

}  // namespace

void read_map(const YAML::Node& node, const std::string& prefix, const std::string& shown, const Keys& table, const Source& source) {
  std::set<std::string> seen;
  read_entries(node, prefix, shown, table, source, seen);
}

void read_value(const YAML::Node& node, const std::string& shown_path, const Key& key, const Source& source) {
  std::visit(ValueReader(node, shown_path, key, source), key.value);
}

}  // namespace lf::config
