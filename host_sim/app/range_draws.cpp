#include "host_sim/app/range_draws.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <concepts>
#include <limits>
#include <set>

#include "hal/config/drive_kind.hpp"
#include "hal/config/share.hpp"
#include "host_sim/scenario/bounds.hpp"
#include "host_sim/scenario/draw.hpp"

namespace lf::app {

namespace {

using config::Key;
using scenario::uniform;

constexpr std::size_t keys_at_once = 8;
constexpr double logarithmic_from = 100;  // a range's end over its beginning

std::string text_of(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// What a text may be; empty: anything.
std::vector<std::string> words_of(const Key& key) {
  return key.path.starts_with("drives.") && key.path.ends_with("profile") ? config::shipped_drive_kinds() : key.words;
}

// Each draw has a generator of its own, made of the key's name.
class Draw {
 public:
  Draw(const Key& key, const scenario::Bounds& bounds, std::uint64_t seed) : key_(key), bounds_(bounds), seed_(seed) {}

  std::string operator()(double*) { return text_of(rounded(number())); }
  template <std::integral Integer>
  std::string operator()(Integer*) {
    return text_of(std::clamp(std::round(number()), bounds_.min, bounds_.max));
  }
  std::string operator()(bool*) { return share() < 0.5 ? "false" : "true"; }
  std::string operator()(config::Spread*) { return text_of(rounded(number())); }
  std::string operator()(config::Chance*) { return share() < 0.5 ? "false" : "true"; }
  std::string operator()(std::array<double, 3>*) { return list(3); }
  std::string operator()(Vec2*) { return list(2); }
  std::string operator()(std::array<Vec2, 3>*) { return "[" + list(2) + ", " + list(2) + ", " + list(2) + "]"; }
  std::string operator()(std::vector<double>*) {
    if (key_.path == "camera.distortion") return list(5);
    if (key_.path == "arm.park_rad") return list(JointNames().arm_joints());
    return list(1 + static_cast<std::size_t>(3 * share()));
  }
  template <std::size_t Count>
  std::string operator()(std::vector<std::array<double, Count>>*) {
    std::string text = "[" + body(Count);
    while (share() < 0.5) text += ", " + body(Count);
    return text + "]";
  }
  std::string operator()(std::vector<config::Task>*) { return "[{turn_valve: {to_deg: " + text_of(rounded(number())) + "}}]"; }
  std::string operator()(PanelLayout::Pointer*) {
    return key_.words[static_cast<std::size_t>(share() * static_cast<double>(key_.words.size()))];
  }
  std::string operator()(std::string*) {
    const std::vector<std::string> words = words_of(key_);
    return words[static_cast<std::size_t>(share() * static_cast<double>(words.size()))];
  }
  std::string operator()(std::vector<std::string>*) {
    std::string text;
    for (const std::string& word : key_.words) {
      if (share() < 0.5) text += (text.empty() ? "" : ", ") + word;
    }
    return "[" + text + "]";
  }
  std::string operator()(std::vector<config::Fault>*) { return ""; }

 private:
  double share() { return uniform(seed_, key_.path + "#" + std::to_string(count_++)); }

  double number() {
    const double at = share();
    const auto [min, max] = bounds_;
    const bool logarithmic = min > 0 && max > logarithmic_from * min;
    return logarithmic ? min * std::pow(max / min, at) : min + (max - min) * at;
  }

  // Four digits: what a person would write.
  double rounded(double value) const {
    if (value == 0) return 0;
    const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - 3);
    return std::clamp(std::round(value / unit) * unit, bounds_.min, bounds_.max);
  }

  std::string list(std::size_t count, std::size_t positive_from = std::numeric_limits<std::size_t>::max()) {
    std::string text = "[";
    for (std::size_t i = 0; i < count; ++i) {
      const double value = rounded(number());
      text += (i > 0 ? ", " : "") + text_of(i >= positive_from ? std::abs(value) : value);
    }
    return text + "]";
  }
  // A place, then its extents or its radius.
  std::string body(std::size_t count) {
    constexpr std::size_t box = 6;
    return list(count, count == box ? 3 : count - 1);
  }

  const Key& key_;
  scenario::Bounds bounds_;
  std::uint64_t seed_;
  int count_ = 0;
};

// The default machine's.
const ArmDescription& arm_of(const scenario::Scenario& scenario) {
  static const ArmDescription arm = load_arm_urdf(config::find_file(scenario.arm.urdf, ""));
  return arm;
}

// What names a run, says how long it may last, or how it is to end.
bool is_about_the_run(const std::string& path) { return path == "time_limit_s" || path == "expect.failure"; }

// A text or a list of texts that may be anything.
bool is_free_text(const Key& key) {
  const bool text = std::holds_alternative<std::string*>(key.value) || std::holds_alternative<std::vector<std::string>*>(key.value);
  return text && words_of(key).empty();
}

// What these say is seen, or where it is looked from.
bool is_seen(const std::string& key) {
  for (const char* group : {"docking.", "water.", "lamps.", "camera.", "laser.", "mounting.", "sensors.", "latency.", "calibration.",
                            "panel.", "tasks", "valve.start_deg", "valve.stop_", "mission.camera_syncs", "mission.frames_per_background",
                            "mission.sweep_speed_rad_s", "mission.verify_band_m"}) {
    if (key.starts_with(group)) return true;
  }
  return false;
}

}  // namespace

std::vector<std::string> drawn_keys() {
  scenario::Scenario scenario;
  std::vector<std::string> paths;
  for (const Key& key : scenario::keys(scenario)) {
    if (!is_free_text(key) && !is_about_the_run(key.path) && !std::holds_alternative<std::vector<config::Fault>*>(key.value))
      paths.push_back(key.path);
  }
  return paths;
}

std::vector<std::string> end_values(const std::string& path) {
  scenario::Scenario scenario;
  for (const Key& key : scenario::keys(scenario)) {
    if (key.path != path) continue;
    const bool number = std::holds_alternative<double*>(key.value) || std::holds_alternative<config::Spread*>(key.value);
    const bool whole = std::holds_alternative<std::int64_t*>(key.value) || std::holds_alternative<std::int32_t*>(key.value) ||
                       std::holds_alternative<std::uint32_t*>(key.value);
    if (!number && !whole) return {};
    const auto [min, max] = scenario::bounds_of(key, scenario, arm_of(scenario));
    if (whole) return {text_of(std::ceil(min)), text_of(std::floor(max))};
    // A bound that other keys make is computed: just inside of it.
    const double inside = 1e-4 * (max - min);
    return {text_of(min > key.min ? min + inside : min), text_of(max < key.max ? max - inside : max)};
  }
  return {};
}

std::string drawn_value(const std::string& path, std::uint64_t draw) {
  scenario::Scenario scenario;
  for (const Key& key : scenario::keys(scenario)) {
    if (key.path == path) return std::visit(Draw(key, scenario::bounds_of(key, scenario, arm_of(scenario)), draw), key.value);
  }
  return "";
}

RangeRow many_row(std::uint64_t index, std::uint64_t combination) {
  const std::vector<std::string> paths = drawn_keys();
  RangeRow row{"many " + std::to_string(index), "many", {}, index, true};
  const std::uint64_t seed = (combinations * 1000 + 1) * combination + index;
  std::set<std::string> taken;
  for (std::size_t k = 0; taken.size() < keys_at_once; ++k) {
    const std::string& path = paths[scenario::bits(seed, "many " + std::to_string(k)) % paths.size()];
    if (!taken.insert(path).second) continue;
    row.set.push_back(path + "=" + drawn_value(path, 1000 + seed));
  }
  return row;
}

std::vector<RangeRow> range_rows(std::size_t draws, std::size_t many) {
  const std::vector<std::string> paths = drawn_keys();
  std::vector<RangeRow> rows;
  for (const std::string& path : paths) {
    for (std::uint64_t draw = 1; draw <= draws; ++draw) {
      const std::string value = drawn_value(path, draw);
      rows.push_back({path + " " + value + " #" + std::to_string(draw), path, {path + "=" + value}, draw, is_seen(path)});
    }
    if (draws == 0) continue;
    const std::vector<std::string> ends = end_values(path);
    for (std::size_t i = 0; i < ends.size(); ++i)
      rows.push_back({path + " " + ends[i] + (i == 0 ? lower_end : upper_end), path, {path + "=" + ends[i]}, i + 1, is_seen(path)});
  }
  for (std::uint64_t i = 1; i <= many; ++i) rows.push_back(many_row(i, 1));
  return rows;
}

}  // namespace lf::app
