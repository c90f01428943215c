// Why a mission failed, in words.
#pragma once

#include <string>

#include "firmware/mission/mission.hpp"
#include "hal/config/error_texts.hpp"

namespace lf::app {

// "drive fault: elbow, EMCY 0x2310 (continuous over-current), in step scan"
std::string reason_of(const mission::Outcome& outcome, const config::ErrorTexts& texts, const mission::Sight& sight);

}  // namespace lf::app
