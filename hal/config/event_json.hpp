// An event of the core as a line of log.jsonl: the vehicle's log and a simulated run's have the same.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "firmware/mission/job.hpp"
#include "firmware/telemetry.hpp"
#include "hal/config/error_texts.hpp"

namespace lf::config {

// Seconds, for JSON: the double that is printed as 15.000172, where Time::s() may be 15.000172000000001.
inline double json_seconds(Time t) { return static_cast<double>(t.ns()) / 1e9; }

// {"t_s", "kind", "step", ...}. A fault has its reaction, its text, and what `cause_of` says of it; a panel that was found what its look left over that an exact
// calibration would explain ("fit"), with a doubt of the calibration where that is too much. `sight` is the newest look's.
nlohmann::ordered_json event_json(const Event& event, const ErrorTexts& texts, const mission::Sight& sight);

// What looks and presses left over: {"marker_side_percent", ..., "faces_off_mm"}, with "doubt" and "remedy" where that is too much. Empty before the first look.
nlohmann::ordered_json fit_json(const mission::CalibrationFit& fit, const mission::TaskResults& results);

// Why a mission failed: {"cause", "remedy", "seen"}, those that there are.
nlohmann::ordered_json cause_json(safety::Fault fault, std::int32_t code, const mission::Sight& sight);

// Of each fault that was reported, how often.
nlohmann::ordered_json fault_counts_json(const std::array<std::uint32_t, safety::fault_count>& counts);

}  // namespace lf::config
