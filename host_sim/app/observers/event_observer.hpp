// log.jsonl of a run, in the format of lanternfishd's: the core's steps, faults with their reactions, and what is counted, a JSON object a line. And the
// faults as records, for result and report.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "hal/config/error_texts.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/observers/run_files.hpp"
#include "host_sim/record/file_sink.hpp"
#include "host_sim/record/result.hpp"

namespace lf::app {

class EventObserver : public hal::SimObserver {
 public:
  // Both outlive the observer. `texts` are those of the drives' error codes.
  EventObserver(RunFiles& files, const config::ErrorTexts& texts);

  void on_telemetry(const Telemetry& telemetry) override;
  // {"t_s", "kind", ...}: what is not the core's to tell.
  void say(const nlohmann::ordered_json& line);
  // The last line, after what was counted since.
  void say_end(const nlohmann::ordered_json& line);
  void finish();

  // Faults and the nodes' error messages, equal ones that follow each other as one, at most record::most_faults.
  const std::vector<record::FaultRecord>& faults() const { return faults_; }
  std::uint64_t faults_left_out() const { return left_out_; }

 private:
  void keep(const Event& event, const mission::Sight& sight);
  void tell_counters(const Telemetry& telemetry);

  RunFiles& files_;
  const config::ErrorTexts& texts_;
  std::optional<record::FileSink> log_;
  std::vector<record::FaultRecord> faults_;
  std::uint64_t left_out_ = 0;
  Telemetry last_;
  nlohmann::ordered_json counters_;
  Time next_counters_;
};

}  // namespace lf::app
