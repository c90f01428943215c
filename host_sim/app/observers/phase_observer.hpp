// The phases of a run as the mission goes through them, told as they end; its decisions go into the digest.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hal/config/error_texts.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/record/digest.hpp"
#include "host_sim/record/result.hpp"

namespace lf::app {

class PhaseObserver : public hal::SimObserver {
 public:
  using Say = std::function<void(const std::string&)>;  // a line of progress

  // `digest` and `texts`, of the drives' error codes, outlive the observer, as does what `say` refers to. `say` may be empty.
  PhaseObserver(record::RunDigest& digest, const config::ErrorTexts& texts, Say say)
      : digest_(digest), texts_(texts), say_(std::move(say)) {}

  void on_telemetry(const Telemetry& telemetry) override;
  void finish(double now_s, const std::string& failure);

  const std::vector<record::PhaseRecord>& phases() const { return phases_; }
  std::string stage() const { return phases_.empty() ? "boot" : phases_.back().name; }

 private:
  void on_event(const Event& event, const mission::Sight& sight);
  void enter_step(const Event& event);
  std::string outcome() const;  // of the phase under way

  record::RunDigest& digest_;
  const config::ErrorTexts& texts_;
  Say say_;
  std::vector<record::PhaseRecord> phases_;
  bool retried_ = false;
  std::string given_up_;  // how, where a fault ended the phase
};

}  // namespace lf::app
