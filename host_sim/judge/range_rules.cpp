#include "host_sim/judge/range_rules.hpp"

#include <algorithm>
#include <cctype>

#include "firmware/mission/step_failure.hpp"
#include "firmware/safety/faults.hpp"

namespace lf::judge {

namespace {

using Words = std::vector<std::string>;
using F = StepFailure;
using Failures = std::vector<StepFailure>;

struct Group {
  const char* beginning;  // of the keys' paths; the first that fits is taken
  Failures failures;      // the causes that it can have
  Words words{};          // parts of other faults' texts, and of what a look saw
};

template <class List, class... More>
List joined(List all, const More&... more) {
  (all.insert(all.end(), more.begin(), more.end()), ...);
  return all;
}

const std::vector<Group>& groups() {
  // Shown by the points of the laser's line: panel, and handle. The lamps are off then, and the marker does not matter.
  static const Failures line{F::no_panel, F::too_few_points, F::plane_unsure, F::no_handle, F::handle_unsure};
  // Shown by the still picture under the lamps.
  static const Failures still{F::no_marker, F::pointer_unsure};
  // Shown by touch.
  static const Failures touch{F::early_contact, F::no_contact,   F::not_gripped,    F::wrong_angle,  F::touched_on_the_way_back,
                              F::slipped,       F::button_stuck, F::button_missing, F::button_yields};
  static const Failures press{F::button_stuck, F::button_missing, F::button_yields, F::early_contact, F::touched_on_the_way_back};
  // No way for the arm.
  static const Failures way{F::unreachable, F::no_motion, F::panel_in_the_way, F::vehicle_in_the_way, F::arm_in_its_own_way};
  static const Failures turn{F::stalled, F::wrong_angle, F::slipped};
  static const Failures bar{F::no_handle, F::handle_unsure, F::pointer_unsure, F::half_turn_open, F::beyond_stops};
  // What lies elsewhere than the core was told makes what is seen contradict itself, then it is missed by touch.
  static const Failures elsewhere = joined(Failures{F::marker_wrong, F::marker_disagrees, F::panel_moved, F::plane_unsure, F::no_handle,
                                                    F::pointer_unsure, F::beyond_stops, F::unreachable, F::panel_in_the_way},
                                           touch);
  // What a motor has to overcome shows as torque, or as a joint that does not follow.
  static const Failures load{F::early_contact,           F::not_gripped, F::wrong_angle, F::jaw_stuck, F::jaw_not_closed,
                             F::touched_on_the_way_back, F::stalled,     F::slipped};
  static const Words load_words{"overload", "following error", "overspeed", "unexpected contact", "grip lost", "drive fault"};
  static const Words turn_words{"overload: roll", "following error: roll", "grip lost"};

  // What a look saw, as hal/config/sight_cause.cpp words it.
  static const Words off_its_place{"the panel stands", "the panel is tilted", "neither marker nor handle"};
  static const Words weak_line{"the laser's line is missing or too weak"};
  static const Words faint{"the water is too turbid", "the laser's line is missing or too weak", "the marker is hidden",
                           "neither marker nor handle"};
  static const Words faint_still{"the water is too turbid", "the marker is hidden", "neither marker nor handle", "the pictures are dark",
                                 "the pictures are white"};
  static const Words noisy{"the pictures are noisy"};
  static const Words no_images{"image lost", "camera silent", "no pictures came", "no still picture came"};

  static const Failures marker = joined(Failures{F::no_marker, F::marker_wrong, F::marker_disagrees, F::panel_moved}, touch);
  static const Words marker_words{"the marker is hidden", "the marker is too small", "neither marker nor handle",
                                  "the water is too turbid"};

  static const std::vector<Group> all{
      {"tasks", joined(turn, bar), turn_words},
      {"docking.", joined(Failures{F::no_marker, F::no_handle, F::panel_moved}, touch, way),
       joined(off_its_place, Words{"overload", "the marker is hidden"})},
      {"valve.start_deg", joined(turn, bar), turn_words},
      {"valve.stop_", joined(turn, bar), turn_words},
      {"valve.", turn, turn_words},
      {"buttons.", press, {"overload"}},
      {"panel.plate_", {F::no_panel, F::too_few_points, F::plane_unsure, F::panel_in_the_way, F::no_motion, F::unreachable}},
      {"panel.handle_", joined(bar, touch, way, Failures{F::stalled, F::jaw_stuck, F::jaw_not_closed}), joined(load_words, off_its_place)},
      {"panel.pointer", {F::pointer_unsure, F::half_turn_open, F::beyond_stops}},
      {"panel.button", joined(press, way, Failures{F::no_marker}), {"overload", "the marker is hidden"}},
      {"panel.marker_size_m", marker, marker_words},
      {"panel.marker_id", marker, marker_words},
      // Its plate stands out of the panel, and motions keep clear of it.
      {"panel.marker_", joined(marker, Failures{F::panel_in_the_way, F::no_motion}), marker_words},
      // Farther off all is fainter and smaller, and comes nearer to the end of the arm's reach.
      {"panel.", joined(line, still, touch, way),
       joined(load_words, faint, off_its_place, Words{"the marker is too small", "joint limit", "tool outside"})},
      {"water.particles_per_l", joined(line, still), joined(faint, noisy)},
      {"water.ambient", joined(line, still, Failures{F::line_misshapen}),
       joined(faint, faint_still, noisy, Words{"the laser's line is white"})},
      {"water.", joined(line, still, Failures{F::line_misshapen}), joined(faint, Words{"the pictures are dark"})},
      {"lamps.", still, faint_still},
      {"camera.always_on", {F::too_few_points}, no_images},
      {"camera.noise_grey", joined(line, still), joined(faint, noisy)},
      {"camera.electrons_per_grey", joined(line, still), joined(faint, noisy)},
      {"camera.exposure_jitter", joined(line, still), joined(faint_still, noisy)},
      {"camera.ghost_", joined(line, Failures{F::line_misshapen})},
      {"camera.exposure_us", joined(line, still, Failures{F::line_misshapen}),
       joined(faint, faint_still, no_images, Words{"the laser's line is white"})},
      {"camera.blur_px", joined(line, still, Failures{F::line_misshapen}), faint},
      {"camera.corner_blur", joined(line, still, Failures{F::line_misshapen}), faint},
      // Where it stands, where it looks, and its lens are told to the core: what is seen is small, faint or askew.
      {"camera.", joined(line, still, Failures{F::marker_wrong, F::marker_disagrees, F::panel_moved, F::line_misshapen}, touch),
       joined(faint, Words{"the marker is too small"})},
      {"laser.position_m", joined(line, way, Failures{F::line_misshapen}), weak_line},
      {"laser.", joined(line, Failures{F::line_misshapen}), {"the laser's line"}},
      {"sensors.", {}, noisy},
      {"mounting.", elsewhere, off_its_place},
      {"calibration.lens_percent", joined(still, Failures{F::line_misshapen, F::plane_unsure}), {"the marker is hidden"}},
      {"calibration.beam_percent", {F::line_misshapen, F::plane_unsure}},
      {"calibration.", elsewhere, off_its_place},
      {"latency.image_ms", {F::no_panel, F::too_few_points, F::handle_unsure}, no_images},
      {"latency.", {}, {"panel vision late"}},
      {"vehicle.", {F::vehicle_in_the_way, F::no_motion, F::unreachable}},
      {"arm.", load, load_words},
      {"jaw.", load, load_words},
      {"physics.", load, load_words},
      {"friction.", load, load_words},
      {"outputs.", {}, {"output node", "boot failed: io", "camera silent"}},
      {"mission.docking_", {F::panel_in_the_way, F::no_motion, F::unreachable}},
      {"mission.camera_syncs", line, joined(no_images, weak_line)},
      {"mission.frames_per_background", joined(line, Failures{F::line_misshapen}), weak_line},
      {"mission.sweep_speed_rad_s", line, weak_line},
      {"mission.verify_band_m", line, weak_line},
      {"mission.press_", press, {"overload"}},
      {"mission.turn_speed_rad_s", turn, turn_words},
      {"mission.valve_tolerance_rad", {F::wrong_angle}},
      {"mission.approach_", joined(press, way, Failures{F::no_contact, F::not_gripped})},
      {"mission.move_speed_fraction", load, load_words},
      // One try makes an end of what a second one would have seen or gripped.
      {"mission.tries", {F::no_handle, F::handle_unsure, F::pointer_unsure, F::not_gripped, F::slipped}, {"grip lost"}},
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

// What a failed step or look says of its cause, without the fault's own name; where it says what the look saw, that alone. All else as it is told. Without the
// advice, and without the step in which it came: a step's name is no cause.
std::string deciding_part(const std::string& told) {
  std::string reason = told.substr(0, std::min(told.find(" ("), told.find(", in step ")));
  for (const safety::Fault fault : {safety::Fault::step_failed, safety::Fault::vision_poor}) {
    const std::string begins = std::string(safety::name(fault)) + ": ";
    if (!reason.starts_with(begins)) continue;
    reason.erase(0, begins.size());
    const std::size_t seen = reason.find(": ");
    return seen == std::string::npos ? reason : reason.substr(seen + 2);
  }
  return reason;
}

bool is_of_a_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// A whole word or path, or with `and_below` the beginning of a longer path.
bool has_word(const std::string& text, const std::string& word, bool and_below = false) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    if (at > 0 && (is_of_a_name(text[at - 1]) || text[at - 1] == '.')) continue;
    const std::string after = text.substr(at + word.size(), 2);
    const bool goes_on = after.size() > 1 && after[0] == '.' && is_of_a_name(after[1]);
    if (after.empty() || (!is_of_a_name(after[0]) && (and_below || !goes_on))) return true;
  }
  return false;
}

// What is inside of `tasks` has names of its own.
bool refusal_names(const std::string& key, const std::string& refusal) {
  const std::size_t dot = key.rfind('.');
  if (dot != std::string::npos)
    return has_word(refusal, key) || (has_word(refusal, key.substr(0, dot), true) && has_word(refusal, key.substr(dot + 1)));
  return refusal.find("'" + key + "'") != std::string::npos ||
         (key == "tasks" && (has_word(refusal, "turn_valve.to_deg") || has_word(refusal, "press_buttons.order")));
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
  if (group == groups().end()) return {};
  Words words = group->words;
  for (const StepFailure failure : group->failures) words.emplace_back(lf::name(failure));
  return words;
}

bool names_a_key(const std::vector<std::string>& keys, const std::string& told) {
  const std::string cause = deciding_part(told);
  return std::any_of(keys.begin(), keys.end(), [&](const std::string& key) {
    const Words words = words_for(key);
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) { return cause.find(word) != std::string::npos; });
  });
}

bool refusal_names_a_key(const std::vector<std::string>& keys, const std::string& refusal) {
  return std::any_of(keys.begin(), keys.end(), [&](const std::string& key) { return refusal_names(key, refusal); });
}

}  // namespace lf::judge
