// EMCY messages (CiA 301, 7.2.7): what each node last complained of, and a short memory of all.
#pragma once

#include <cstdint>

#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::canopen {

struct Emcy {
  std::uint16_t code = 0;           // 0x0000: the error is gone
  std::uint8_t error_register = 0;  // object 1001
  std::uint8_t node = 0;
  Time time;  // of its arrival
};

// What a code means: that of its exact value where this project knows one, else that of its class (CiA 301, table 26; CiA 402-2).
const char* emcy_name(std::uint16_t code);

// Little-endian code, register, five manufacturer's bytes. `frame` has 8 bytes.
Emcy decode_emcy(const CanFrame& frame, Time now);

}  // namespace lf::canopen
