// Status and log in JSON: the same names in both. Times are seconds on CLOCK_MONOTONIC, angles radians, torques N m.
#pragma once

#include <nlohmann/json.hpp>

#include "firmware/telemetry.hpp"
#include "hal/config/error_texts.hpp"
#include "hal/vehicle/control_report.hpp"
#include "hal/vehicle/latency_histogram.hpp"
#include "shared/panel/panel_names.hpp"

namespace lf::hal {

using Json = nlohmann::ordered_json;

const char* name(Port port);

// {"count", "p50", "p99", "p999", "max"} in us.
Json histogram_json(const LatencyHistogram& histogram);
// Everything that is counted and is not zero: faults, platform calls that failed, refused frames, CAN errors, camera troubles, missed ticks ... The names are
// those of docs/operating.md.
Json counters_json(const ControlReport& control, const CameraReport& camera, const Telemetry& telemetry);
// Mission, tasks, joints, nodes, inputs and outputs. `texts`: what the drives' error codes mean; `names`: of the panel's features.
Json status_json(const ControlReport& control, const Telemetry& telemetry, const config::ErrorTexts& texts, const PanelNames& names);

}  // namespace lf::hal
