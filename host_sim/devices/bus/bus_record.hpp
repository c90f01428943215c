// A frame as it passed on the bus, and what the bus counted.
#pragma once

#include <cstdint>

#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::devices {

struct BusRecord {
  CanFrame frame;
  Time delivered;           // the last bit of its end of frame
  std::uint8_t sender = 0;  // node number; can_map::master_node is the master
};

struct BusStats {
  std::uint64_t frames = 0;  // delivered
  std::uint64_t bits = 0;    // of all, stuffing, error frames and interframe space included
  std::uint64_t errors = 0;  // error frames
  std::uint64_t lost = 0;    // frames dropped by a fault, by a full queue or by a controller off the bus
  double load_percent = 0;   // mean since the first frame, of `bits`
  // The same frames without their stuff bits, and with as many as any content could need. What a frame really has lies between the two.
  double load_unstuffed_percent = 0;
  double load_worst_case_percent = 0;
  double peak_load_percent = 0;  // worst window of 100 ms
};

}  // namespace lf::devices
