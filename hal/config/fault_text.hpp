// A fault in words: what happened, where, and what the node itself said of it.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/mission/sight.hpp"
#include "firmware/safety/faults.hpp"
#include "hal/config/error_texts.hpp"

namespace lf::config {

// "drive fault: elbow, EMCY 0x2310 (continuous over-current)". `code` and `emcy` as in an Event or an Outcome; `texts` says what the
// code means on that joint's drive; `sight` is the newest look's, by which one that failed is explained (cause.hpp).
std::string fault_text(safety::Fault fault, std::int32_t code, std::uint16_t emcy, const ErrorTexts& texts, const mission::Sight& sight);

}  // namespace lf::config
