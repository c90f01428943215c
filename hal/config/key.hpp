// A key of a YAML file: its path, unit, range, words and meaning, bound to where its value is kept. Tables of keys are what readers, schemas, listings and
// documentation come from.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "hal/config/spread.hpp"
#include "shared/arm/joint_names.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::config {

// One thing to do at the panel.
struct Task {
  enum class Kind : std::uint8_t { turn_valve, press_buttons };
  Kind kind = Kind::turn_valve;
  double to_deg = 90;
  std::string valve{};  // its name; empty: the panel's only one
  std::vector<std::string> order{"left", "centre", "right"};
};

// Something that goes wrong during a simulated run; fault_kinds.hpp says what each kind does.
struct Fault {
  double at_s = 0;
  std::string at_step;  // a step of the mission; empty: `at_s` counts from power-on
  double after_s = 0;   // after `at_step` began for the first time
  std::string kind = "overcurrent";
  std::string node;         // slew, shoulder, elbow, roll, jaw, io or master, where the kind is a node's
  double duration_s = 0;    // 0: for the rest of the run
  std::int64_t can_id = 0;  // drop_frames only
};

using KeyValue = std::variant<double*, std::int64_t*, std::int32_t*, std::uint32_t*, bool*, std::string*, Spread*, Chance*,
                              PanelLayout::Pointer*, std::array<double, 3>*, Vec2*, std::array<Vec2, 3>*, std::vector<double>*,
                              std::vector<std::array<double, 3>>*, std::vector<std::array<double, 6>>*, std::vector<std::array<double, 7>>*,
                              std::vector<std::string>*, std::vector<Task>*, std::vector<Fault>*>;

struct Key {
  std::string path;  // "valve.start_deg"
  std::string doc;   // one line
  std::string unit;  // "" where there is none
  double min = 0;    // of every number in the value, both ends of a spread included
  double max = 0;
  KeyValue value;                    // where it is kept
  std::vector<std::string> words{};  // what a text, or each text of a list, may be; empty: anything
  // Of the panel's buttons, where the value is tasks; empty: any name is taken. Of the joints, where it is faults.
  std::vector<std::string> names{};
  std::size_t above_zero_from = SIZE_MAX;  // in a list of lists: of each, the numbers from this one on have to be above 0
};

using Keys = std::vector<Key>;

// The words for a handle's pointer, in the order of the enumeration.
inline constexpr std::array<const char*, 3> pointer_words{"none", "light_end", "dark_end"};

Key key(std::string path, std::string unit, double min, double max, KeyValue value, std::string doc, std::vector<std::string> words = {});

// The pointers are into the argument.
// `buttons`: the panel's; empty: any name is taken.
Keys keys(Task& task, const std::vector<std::string>& buttons);  // paths "turn_valve.valve", "turn_valve.to_deg", "press_buttons.order"
Keys keys(Fault& fault, const JointNames& joints = {});

// "a number", "a number or {min: , max: }", "true or false" ...: what the key takes, in words.
std::string type_name(const Key& key);

}  // namespace lf::config
