// Presses a button: to a stand-off, straight into it until the torque says that it has bottomed, and straight back. It is pressed when it went in by half its
// stroke; one that is stuck and one that is not there are told apart by what the press felt like.
#pragma once

#include <array>
#include <optional>

#include "firmware/arm/guarded_motion.hpp"
#include "firmware/mission/button_feel.hpp"
#include "firmware/mission/workbench.hpp"

namespace lf::mission {

// The face is where the look says to 3 mm, and the tip where the joints say to 2: what is touched farther out is something else, and what is touched so much
// deeper than its bottom is not the button.
inline constexpr double press_face_m = 0.008;

class PressButton {
 public:
  Progress begin(const StepTick& tick);
  Progress run(const StepTick& tick);
  // Of `press`: a press that bottoms while it is on hold stays there without pushing, and is judged when it is resumed.
  void watch_on_hold(const StepTick& tick);

 private:
  Progress begin_reach(Workbench& bench);
  // The tool's turn about its approach axis for this try, and the stand-off's pose; nothing where no turn is left that reaches it.
  std::optional<arm::JointVector> choose_roll(Workbench& bench);
  // Where something bars this turn of the hand, the next try takes another.
  Progress follow(Progress motion);
  Progress run_reach(const StepTick& tick);
  Progress begin_press(Workbench& bench);
  Progress run_press(const StepTick& tick);
  Progress run_back(const StepTick& tick);
  void sense(const StepTick& tick);
  void learn_under_way(const Workbench& bench);
  void compare_with_rest(const Workbench& bench);
  bool met_something() const { return guard_.touched() || pushed_joint_; }
  // The joint by whose own doing it is no button and no contact.
  std::optional<std::size_t> misled_joint(const Workbench& bench) const;
  void feel(const StepTick& tick);
  // What stopped the finger, or what it is that nothing did.
  StepFailure judge(const Workbench& bench) const;

  arm::GuardedMotion guard_{arm::GuardConfig(0)};  // of the press, where touching is meant to happen
  ButtonFeel feel_;
  // The hand's turns about its approach axis in the order of the tries. A hand that is tilted to the panel comes nearest to it with its broad side: from 45
  // degrees on it was clear wherever it was tried. 80 leave room within a wrist of a quarter turn.
  static constexpr std::array rolls_rad{0.0, 1.4, -1.4};
  std::size_t roll_ = 0;                         // the one that this try takes
  std::array<bool, rolls_rad.size()> barred_{};  // those in whose way something was, in this task
  StepFailure barrier_ = StepFailure::none;      // what it was, the last time
  bool pressed_ = false;
  bool learned_under_way_ = false;
  std::optional<std::size_t> pushed_joint_;  // its torque changed by more than friction, and most, since rest
  std::optional<arm::JointVector> rest_nm_;  // what the joints took at rest, until it is compared
  double bottom_m_ = 0;                      // the tip's depth below the face where it is believed to be, at the press's end
};

}  // namespace lf::mission
