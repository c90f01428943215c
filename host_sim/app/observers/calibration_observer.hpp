// What the core's looks leave over that an exact calibration would explain.
#pragma once

#include <optional>

#include "hal/sim/sim_platform.hpp"
#include "host_sim/record/result.hpp"

namespace lf::app {

class CalibrationObserver : public hal::SimObserver {
 public:
  void on_telemetry(const Telemetry& telemetry) override;

  // The largest of each, without a doubt; nothing when no look found plane and marker.
  const std::optional<record::CalibrationRecord>& record() const { return record_; }
  // Of the look that fits worst.
  const mission::CalibrationFit& worst_fit() const { return worst_fit_; }

 private:
  std::uint32_t look_ = 0;
  std::optional<record::CalibrationRecord> record_;
  mission::CalibrationFit worst_fit_;
  double worst_ = -1;
};

}  // namespace lf::app
