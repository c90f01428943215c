// A fault in words: what happened, where, and what the node itself said of it.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/safety/faults.hpp"

namespace lf::config {

// "drive fault: elbow, EMCY 0x2310 (continuous over-current)". `code` and `emcy` as in an Event or an Outcome.
std::string fault_text(safety::Fault fault, std::int32_t code, std::uint16_t emcy);
// "slew" to "jaw", "io" for the output node, else the number.
std::string node_text(std::int32_t index);

}  // namespace lf::config
