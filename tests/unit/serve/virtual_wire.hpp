// A bus and a clock that stand still unless somebody waits: serve and a master on it, without a kernel's CAN and as fast as the machine goes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <vector>

#include "host_sim/serve/can_link.hpp"

namespace lf::serve::test {

class VirtualClock {
 public:
  Time now;
};

// One party's plug. What a party sends, all others hear 50 us later, as a frame of some 110 bits takes at 1 Mbit/s and a half.
class Wire {
 public:
  class Plug : public CanLink {
   public:
    Plug(Wire& wire, VirtualClock& clock) : wire_(wire), clock_(clock) { wire.plugs_.push_back(this); }
    Plug(const Plug&) = delete;
    Plug& operator=(const Plug&) = delete;

    Time now() override { return clock_.now; }
    bool wait(Time until) override {
      if (!inbox_.empty() && inbox_.front().t <= std::max(until, clock_.now)) {
        clock_.now = std::max(clock_.now, inbox_.front().t);
        return true;
      }
      clock_.now = std::max(clock_.now, until);
      return false;
    }
    void sleep(Time until) override { clock_.now = std::max(clock_.now, until); }
    hal::PortStatus receive(hal::ReceivedFrame& received) override {
      if (error != 0) return error;
      if (inbox_.empty() || inbox_.front().t > clock_.now) return hal::port_empty;
      received = inbox_.front();
      inbox_.pop_front();
      return hal::port_ok;
    }
    hal::PortStatus send(std::span<const CanFrame> frames) override {
      for (const CanFrame& frame : frames) {
        sent.push_back(frame);
        for (Plug* other : wire_.plugs_) {
          if (other != this) other->inbox_.push_back({frame, clock_.now + Duration::from_us(50)});
        }
      }
      return hal::port_ok;
    }

    std::vector<CanFrame> sent;
    int error = 0;  // what receive() answers, if not 0

   private:
    Wire& wire_;
    VirtualClock& clock_;
    std::deque<hal::ReceivedFrame> inbox_;
  };

 private:
  std::vector<Plug*> plugs_;
};

}  // namespace lf::serve::test
