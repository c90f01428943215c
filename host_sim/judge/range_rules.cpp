#include "host_sim/judge/range_rules.hpp"

#include <algorithm>

namespace lf::judge {

namespace {

using Words = std::vector<std::string>;

struct Group {
  const char* beginning;  // of the keys' paths; the first that fits is taken
  Words words;
};

// What is not seen well is missed in the picture: panel, marker, handle with its mark, and the points of a scan.
const Words& sight() {
  static const Words words{"panel", "marker", "handle", "pointer", "points", "image", "camera", "wrong angle"};
  return words;
}

// What lies elsewhere than it seems is missed by eye, or by touch.
const Words& place() {
  static const Words words{
      "panel",        "marker",     "handle", "pointer", "points", "button", "the jaw holds nothing", "touched something",
      "out of reach", "wrong angle"};
  return words;
}

// What a motor has to overcome shows as torque, or as a joint that does not follow.
const Words& load() {
  static const Words words{"overload", "following error", "overspeed", "unexpected contact", "touched",    "stalled",
                           "slipped",  "grip lost",       "the jaw",   "drive fault",        "wrong angle"};
  return words;
}

const Words& press() {
  static const Words words{"button", "overload", "touched something", "press"};
  return words;
}

const std::vector<Group>& groups() {
  static const std::vector<Group> all{
      {"tasks", {"turn", "valve", "handle", "wrong angle"}},
      {"docking.", place()},
      {"valve.", {"stalled", "turn", "valve", "handle", "wrong angle", "overload: roll", "following error: roll"}},
      {"buttons.", press()},
      {"panel.", place()},
      {"water.", sight()},
      {"lamps.", sight()},
      {"camera.", sight()},
      {"laser.", sight()},
      {"sensors.", sight()},
      {"mounting.", place()},
      {"calibration.", place()},
      {"latency.image_ms", {"image", "camera", "points", "handle", "panel"}},
      {"latency.", {"panel vision"}},
      {"vehicle.", {"in the way", "out of reach", "vehicle"}},
      {"arm.", load()},
      {"jaw.", load()},
      {"physics.", load()},
      {"friction.", load()},
      {"outputs.", {"output node", "boot failed: io", "camera silent"}},
      {"mission.docking_", {"panel", "in the way", "out of reach"}},
      {"mission.camera_syncs", sight()},
      {"mission.frames_per_background", sight()},
      {"mission.sweep_speed_rad_s", sight()},
      {"mission.verify_band_m", sight()},
      {"mission.press_", press()},
      {"mission.turn_speed_rad_s", {"turn", "stalled", "following error: roll", "overload: roll"}},
      {"mission.valve_tolerance_rad", {"angle"}},
      {"mission.approach_", {"in the way", "out of reach", "touched something", "button", "handle"}},
      {"mission.move_speed_fraction", load()},
      {"mission.tries", {"panel vision"}},
  };
  return all;
}

// "slew" of "drives.slew.node"; nothing for what concerns all drives.
std::string joint_of(const std::string& key) {
  constexpr std::string_view group = "drives.";
  if (!key.starts_with(group)) return "";
  const std::size_t end = key.find('.', group.size());
  return end == std::string::npos ? "" : key.substr(group.size(), end - group.size());
}

}  // namespace

std::vector<std::string> words_for(const std::string& key) {
  const std::string joint = joint_of(key);
  if (!joint.empty()) {
    Words words;
    for (const char* fault :
         {"boot failed: ", "drive fault: ", "following error: ", "overload: ", "overspeed: ", "joint limit: ", "unexpected contact: "})
      words.push_back(fault + joint);
    return words;
  }
  if (key.starts_with("drives.")) return {"boot failed", "drive fault", "following error", "overload", "overspeed"};
  const auto group = std::find_if(groups().begin(), groups().end(), [&](const Group& one) { return key.starts_with(one.beginning); });
  return group == groups().end() ? Words{} : group->words;
}

bool names_a_key(const std::vector<std::string>& keys, const std::string& told) {
  // Without the advice, and without the step in which it came: a step's name is no cause.
  const std::string reason = told.substr(0, std::min(told.find(" ("), told.find(", in step ")));
  return std::any_of(keys.begin(), keys.end(), [&](const std::string& key) {
    const Words words = words_for(key);
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) { return reason.find(word) != std::string::npos; });
  });
}

}  // namespace lf::judge
