// A camera's shutter from the trigger to its closing: when it opens, and for which share of that time the lights were on.
//
// It opens some time after the trigger, which the core takes for the start: the camera's own delay and the offset of two clocks. An output that is switched meanwhile
// lights a part of the picture's light.
#pragma once

#include <algorithm>

#include "shared/messages/time.hpp"

namespace lf::hal {

class Shutter {
 public:
  Shutter() = default;
  Shutter(Time trigger, Duration delay, Duration open_for) : opens_(trigger + delay), closes_(opens_ + open_for) {}

  // What the lights did from `begin` to `end`: a step of the physics, to which the shares are exact.
  void pass(Time begin, Time end, bool laser, bool lamps) {
    const Duration open = std::min(end, closes_) - std::max(begin, opens_);
    if (open <= Duration()) return;
    if (laser) laser_ = laser_ + open;
    if (lamps) lamps_ = lamps_ + open;
  }

  bool closed(Time now) const { return now >= closes_; }
  Time middle() const { return opens_ + (closes_ - opens_) / 2; }
  float laser_share() const { return share(laser_); }
  float lamp_share() const { return share(lamps_); }

 private:
  float share(Duration on) const { return closes_ > opens_ ? static_cast<float>(on.s() / (closes_ - opens_).s()) : 0.f; }

  Time opens_, closes_;
  Duration laser_, lamps_;
};

}  // namespace lf::hal
