// How a step stands after it was begun or run: under way, over by one of its ways out, or failed.
#pragma once

#include <cstdint>

#include "firmware/telemetry.hpp"
#include "shared/messages/time.hpp"

namespace lf::mission {

struct Progress {
  enum class Kind : std::uint8_t {
    running,
    done,          // leads to the row's `on_done`
    other_way,     // to `on_branch`
    nothing_left,  // to `on_end`
    failed,        // a fault, with its reaction
  };
  Kind kind = Kind::running;
  StepFailure failure = StepFailure::none;
  bool out_of_tries = false;  // failed for good: the step counted its tries itself
  bool touched = false;       // for good, and the arm stays where it is

  static constexpr Progress running() { return {}; }
  static constexpr Progress done() { return {Kind::done}; }
  static constexpr Progress other_way() { return {Kind::other_way}; }
  static constexpr Progress nothing_left() { return {Kind::nothing_left}; }
  static constexpr Progress failed(StepFailure failure) { return {Kind::failed, failure}; }
  static constexpr Progress failed_for_good(StepFailure failure) { return {Kind::failed, failure, true}; }
  static constexpr Progress failed_by_touch(StepFailure failure) { return {Kind::failed, failure, true, true}; }
  static constexpr Progress done_if(bool condition) { return condition ? done() : running(); }

  bool is_running() const { return kind == Kind::running; }
  bool is_done() const { return kind == Kind::done; }
};

// The time of one step. It stands still while the operator holds the arm.
class StepClock {
 public:
  void start(Time now) {
    since_ = now;
    settling_ = false;
    planned_ = Duration{};
  }
  // The step is planned to take so long, by a motion or by a wait: its time-out begins after that.
  void expect(Duration planned) { planned_ = planned > planned_ ? planned : planned_; }
  Duration planned() const { return planned_; }
  void wait(Duration period) {
    since_ = since_ + period;
    settled_since_ = settled_since_ + period;
  }
  Duration elapsed(Time now) const { return now - since_; }

  // True once the condition has held for `for_how_long`.
  bool settled(bool condition, Duration for_how_long, Time now) {
    if (!condition) {
      settling_ = false;
    } else if (!settling_) {
      settling_ = true;
      settled_since_ = now;
    }
    return settling_ && now - settled_since_ >= for_how_long;
  }

 private:
  Time since_;
  Time settled_since_;
  Duration planned_;
  bool settling_ = false;
};

}  // namespace lf::mission
