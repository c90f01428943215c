// What a finished run came to, gathered from the core's own account and from the truth.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/controller.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/core_loop.hpp"
#include "hal/sim/sim_config.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/run_recorder.hpp"
#include "host_sim/record/result.hpp"
#include "host_sim/scenario/draw.hpp"

namespace lf::app {

// Why the mission did not succeed by its own account; nothing when it did.
std::optional<record::FailureRecord> failure_of(const Controller& controller, const config::ErrorTexts& texts, const world::World& world,
                                                const RunRecorder& recorder, const scenario::Scenario& scenario, bool interrupted);
// Where the truth contradicts a mission that believes it succeeded.
std::optional<record::FailureRecord> disagreement(const Controller& controller, const world::World& world, const RunRecorder& recorder,
                                                  const PanelNames& names);

// Of looks and presses; nothing when no look found plane and marker.
std::optional<record::CalibrationRecord> calibration_of(const CalibrationObserver& looks, const mission::TaskResults& results);

// Done when the core says so and the truth agrees (judge::truly_done).
std::vector<record::TaskRecord> task_records(const Controller& controller, const world::World& world, const RunRecorder& recorder,
                                             const PanelNames& names);

// Those that the run ended before, or whose step it never came to: "overcurrent elbow, at step free jaw". The platform has flown the run.
std::vector<std::string> faults_not_made(const scenario::Scenario& scenario, const hal::SimPlatform& platform);

record::ErrorRecord score(const RunRecorder& recorder, const hal::SimConfig& truth);

std::map<std::string, std::uint64_t> rejected_inputs(const Controller& controller, const ScanPipeline& pipeline,
                                                     const hal::CoreRings& rings);

// The drawn quantities, for the report; `joints`: how many the arm has.
std::vector<std::pair<std::string, std::string>> conditions(const scenario::Sample& sample);
record::DrawnRecord drawn(const scenario::Sample& sample, std::size_t joints);

}  // namespace lf::app
