#include "shared/urdf/element.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

#include "shared/input_error.hpp"

namespace lf::urdf {
namespace {

constexpr std::size_t most_told = 50;     // two screens
constexpr std::size_t most_kept = 10000;  // of a file of 16 MB that is wrong throughout
constexpr std::size_t longest_name = 256;
constexpr std::string_view our_prefix = "lanternfish:";

// XML's white space, whatever the locale.
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }
bool contains(const std::vector<std::string_view>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}
bool has_prefix(std::string_view name) { return name.find(':') != std::string_view::npos; }
std::string with_brackets(std::string_view name) {
  std::string result = shown(name);
  result.front() = '<';
  result.back() = '>';
  return result;
}

// What this project's own elements hold: parent, element, keys that are needed, and keys that may be left out.
struct OwnElement {
  std::string_view parent;
  std::string_view element;
  std::vector<std::string_view> keys;
  std::vector<std::string_view> optional_keys{};
};
const std::vector<OwnElement>& own_elements() {
  static const std::vector<OwnElement> table{
      {"link", "wet_weight", {"n"}},
      {"collision", "friction", {"coefficient"}},
      {"joint",
       "drive",
       {"rated_torque_nm", "acceleration_rad_s2", "stiction_rad_s", "backlash_rad", "holding_torque_nm"},
       {"stiffness_nm_rad"}},
      {"joint", "friction", {"coulomb_share", "viscous_share", "efficiency", "back_efficiency"}},
      {"joint", "screw", {"pivot_a_m", "pivot_b_m", "offset_rad", "counts_per_m"}},
      {"joint", "gear", {"rad_per_count"}},
  };
  return table;
}

// Why a word is no number.
const char* remedy_for(std::string_view word) {
  if (word.find(',') != std::string_view::npos) return "; write a decimal point, and spaces between numbers";
  if (word.find_first_of("nN") != std::string_view::npos && word.find_first_of("aAiI") != std::string_view::npos)
    return "; it has to be finite";
  return "";
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < text.size();) {
    if (is_space(text[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < text.size() && !is_space(text[end])) ++end;
    words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

// The whole word, decimal, finite. A leading plus is allowed, as in other readers.
std::optional<double> parse(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// Roll, then pitch, then yaw, each about the parent's axes.
Pose turned(Pose pose, const Vec3& rpy) {
  using Eigen::AngleAxisd;
  pose.linear() =
      (AngleAxisd(rpy.z(), Vec3::UnitZ()) * AngleAxisd(rpy.y(), Vec3::UnitY()) * AngleAxisd(rpy.x(), Vec3::UnitX())).toRotationMatrix();
  return pose;
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

}  // namespace

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::string result = "'";
  for (const char c : text.substr(0, longest)) result += is_control(c) ? '?' : c;
  return result + (text.size() > longest ? "...'" : "'");
}

std::string listed(std::span<const std::string_view> words) {
  std::string result;
  for (std::size_t i = 0; i < words.size(); ++i) result.append(i == 0 ? "" : i + 1 == words.size() ? " and " : ", ").append(words[i]);
  return result;
}

void Report::problem(int line, const std::string& text) {
  ++found_;
  if (problems_.size() < most_kept) problems_.push_back({line, text});
}

void Report::note(int line, const std::string& text) {
  if (notes_.size() == most_kept) return;
  notes_.push_back({line, text});
  if (notes_.size() == most_kept) problem(line, "is the " + std::to_string(most_kept) + "th remark on this file: is it a URDF?");
}

void Report::refuse() const {
  if (problems_.empty()) return;
  std::vector<Note> sorted = problems_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Note& a, const Note& b) { return a.line < b.line; });
  std::string message;
  for (std::size_t i = 0; i < std::min(sorted.size(), most_told); ++i)
    message.append(i == 0 ? "" : "\n").append(InputError(file_, sorted[i].line, sorted[i].text).what());
  if (found_ > most_told) message += "\n" + file_ + ": and " + std::to_string(found_ - most_told) + " more problems";
  throw InputError(message);
}

std::vector<Note> Report::notes() const {
  std::vector<Note> sorted = notes_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Note& a, const Note& b) { return a.line < b.line; });
  return sorted;
}

std::string Element::label() const {
  const char* const own = at_->Attribute("name");
  if (own != nullptr && (name() == "link" || name() == "joint" || name() == "robot")) return std::string(name()) + " " + shown(own);
  // The next element around it that has a name.
  const auto* around = at_->Parent() == nullptr ? nullptr : at_->Parent()->ToElement();
  while (around != nullptr && around->Attribute("name") == nullptr && around->Parent() != nullptr) around = around->Parent()->ToElement();
  const bool below_robot = around != nullptr && around->Parent() != nullptr && around->Parent()->ToElement() != nullptr;
  std::string result = with_brackets(name());
  if (own != nullptr) result += " " + shown(own);
  if (below_robot)
    result += " of " + std::string(std::string_view(around->Name()).substr(0, longest_name)) + " " + shown(around->Attribute("name"));
  return result;
}

void Element::check(const Table& table) const {
  check_attributes(table);
  check_children(table);
  check_text();
}

void Element::check_attributes(const Table& table) const {
  for (const auto* a = at_->FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string_view attribute = a->Name();
    if (contains(table.attributes, attribute)) continue;
    if (attribute == "xmlns" || attribute.starts_with("xmlns:") || attribute.starts_with("xml:")) continue;  // XML's own
    if (contains(table.unused_attributes, attribute)) {
      report_->note(a->GetLineNum(), label() + ": attribute " + shown(attribute) + " is not used");
      continue;
    }
    if (has_prefix(attribute)) {
      report_->note(a->GetLineNum(), label() + ": attribute " + shown(attribute) + " is another program's and is not used");
      continue;
    }
    const std::string known = table.attributes.empty() ? "it has none" : "it may have " + listed(table.attributes);
    report_->problem(a->GetLineNum(), label() + " has an unknown attribute " + shown(attribute) + ": " + known);
  }
}

void Element::check_children(const Table& table) const {
  std::vector<std::string_view> seen;
  for (const Element& e : children()) {
    const std::string_view child = e.name();
    if (contains(table.once, child)) {
      if (!contains(seen, child))
        seen.push_back(child);
      else if (child == "origin")
        e.note("comes a second time; the first is used, as other readers do. Remove one");
      else
        e.problem("comes a second time: remove one");
    } else if (contains(table.unused, child)) {
      e.note("is not used");
    } else if (child.starts_with(our_prefix)) {
      if (!contains(table.ours, child.substr(our_prefix.size()))) e.problem("is not known in <" + std::string(name()) + ">: remove it");
    } else if (has_prefix(child)) {
      e.note("is another program's and is not used");
    } else if (!contains(table.many, child)) {
      std::vector<std::string_view> known = table.once;
      known.insert(known.end(), table.many.begin(), table.many.end());
      const std::string may = known.empty() ? "is empty" : "may hold " + listed(known);
      e.problem("is not known here: " + with_brackets(name()) + " " + may);
    }
  }
}

void Element::check_text() const {
  for (const auto* node = at_->FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToText() == nullptr) continue;
    const std::string_view text = node->Value() == nullptr ? "" : node->Value();
    const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
    if (begin == text.end()) continue;
    report_->note(node->GetLineNum(), label() + " holds the text " + shown(text.substr(static_cast<std::size_t>(begin - text.begin()))) +
                                          ", which is not used");
  }
}

std::optional<Element> Element::child(const char* name) const {
  const auto* found = at_->FirstChildElement(name);
  if (found == nullptr) return std::nullopt;
  return Element(found, *report_);
}

std::vector<Element> Element::children(const char* name) const {
  std::vector<Element> result;
  for (const auto* e = at_->FirstChildElement(name); e != nullptr; e = e->NextSiblingElement(name)) result.emplace_back(e, *report_);
  return result;
}

std::vector<Element> Element::children() const { return children(nullptr); }

std::optional<Element> Element::needed_child(const char* name, const char* remedy) const {
  const auto found = child(name);
  if (!found) problem("has no <" + std::string(name) + ">: " + remedy);
  return found;
}

std::string_view Element::text(const char* attribute) const {
  const char* const value = at_->Attribute(attribute);
  return value == nullptr ? "" : value;
}

std::string_view Element::needed_text(const char* attribute, const char* remedy) const {
  const std::string_view value = text(attribute);
  if (value.empty()) problem("has no " + std::string(attribute) + ": " + remedy);
  return value;
}

std::string Element::needed_name(const char* attribute) const {
  const std::string_view value = needed_text(attribute, "give one");
  if (value.empty()) return "";
  const bool clean = std::none_of(value.begin(), value.end(), is_control);
  if (!clean || is_space(value.front()) || is_space(value.back()))
    problem(std::string(attribute) + "=" + shown(value) + " begins or ends with white space or holds a control character: remove it");
  else if (value.size() > longest_name)
    problem(std::string(attribute) + " has more than " + std::to_string(longest_name) + " bytes: shorten it");
  else
    return std::string(value);
  return "";
}

bool Element::numbers(const char* attribute, std::span<double> values, const Bounds& bounds) const {
  if (!has(attribute)) {
    problem("has no " + std::string(attribute) + ": give it");
    return false;
  }
  const std::string_view whole = text(attribute);
  const std::vector<std::string_view> words = words_of(whole);
  const std::string said = std::string(attribute) + "=" + shown(whole);
  std::vector<double> read;
  for (const std::string_view word : words) {
    const auto value = parse(word);
    if (!value) {
      problem(said + ": " + shown(word) + " is no number" + remedy_for(word));
      return false;
    }
    if (*value < bounds.lowest || *value > bounds.highest) {
      problem(said + ": it has to be from " + shortest(bounds.lowest) + " to " + shortest(bounds.highest) + "; " + bounds.remedy);
      return false;
    }
    read.push_back(*value);
  }
  if (read.size() != values.size()) {
    problem(said + " has to be " + (values.size() == 1 ? "one number" : std::to_string(values.size()) + " numbers"));
    return false;
  }
  std::copy(read.begin(), read.end(), values.begin());
  return true;
}

double Element::number(const char* attribute, double missing, const Bounds& bounds) const {
  if (has(attribute)) numbers(attribute, {&missing, 1}, bounds);
  return missing;
}

std::optional<double> Element::needed_number(const char* attribute, const Bounds& bounds) const {
  double value = 0;
  if (!numbers(attribute, {&value, 1}, bounds)) return std::nullopt;
  return value;
}

Pose Element::origin() const {
  Pose pose = Pose::Identity();
  const auto origin = child("origin");
  if (!origin) return pose;
  origin->check({.attributes = {"xyz", "rpy"}});
  if (origin->has("xyz")) origin->numbers("xyz", std::span(pose.translation().data(), 3), a_length);
  Vec3 rpy = Vec3::Zero();
  if (!origin->has("rpy") || !origin->numbers("rpy", std::span(rpy.data(), 3), an_angle)) return pose;
  constexpr double rounding_rad = 0.01;  // half a turn is written as 3.142 or 3.15, too
  if (rpy.cwiseAbs().maxCoeff() > pi + rounding_rad)
    origin->note("has an rpy beyond half a turn. It is taken in radians; were degrees meant?");
  // Four digits of pi/2 leave axes 4e-6 rad off a right angle: told, not mended. Ten digits leave 2e-10, which nobody can measure.
  if (name() != "joint") return turned(pose, rpy);
  for (const double angle : rpy) {
    const double off = std::abs(angle - std::round(angle / (pi / 2)) * (pi / 2));
    if (off > 1e-7 && off < 1e-3) {
      origin->note("has an rpy " + shortest(std::round(off * 1e9) / 1e9) +
                   " rad off a multiple of a right angle. It is used as it is; write more digits");
      break;
    }
  }
  return turned(pose, rpy);
}

std::vector<Extension> Element::extensions() const {
  std::vector<Extension> result;
  for (const Element& e : children()) {
    if (!e.name().starts_with(our_prefix)) continue;
    const std::string_view own = e.name().substr(our_prefix.size());
    const auto row = std::find_if(own_elements().begin(), own_elements().end(),
                                  [&](const OwnElement& known) { return known.parent == name() && known.element == own; });
    if (row == own_elements().end()) continue;  // check() has refused it
    const bool again = std::any_of(result.begin(), result.end(), [&](const Extension& earlier) { return earlier.element == own; });
    if (again) e.problem("comes a second time: remove one");
    std::vector<std::string_view> known = row->keys;
    known.insert(known.end(), row->optional_keys.begin(), row->optional_keys.end());
    e.check({.attributes = known});
    Extension extension{std::string(own), e.line(), {}};
    for (const std::string_view key : known) {
      const bool needed = contains(row->keys, key) || e.has(std::string(key).c_str());
      if (!needed) continue;
      if (const auto value = e.needed_number(std::string(key).c_str(), any_number)) extension.numbers.emplace_back(key, *value);
    }
    result.push_back(std::move(extension));
  }
  return result;
}

}  // namespace lf::urdf
