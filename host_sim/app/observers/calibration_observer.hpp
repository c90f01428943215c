// What the core's looks leave over that an exact calibration would explain.
#pragma once

#include <optional>

#include "hal/sim/sim_platform.hpp"
#include "host_sim/record/result.hpp"

namespace lf::app {

class CalibrationObserver : public hal::SimObserver {
 public:
  void on_telemetry(const Telemetry& telemetry) override;

  const std::optional<record::CalibrationRecord>& record() const { return record_; }

 private:
  std::uint32_t look_ = 0;
  std::optional<record::CalibrationRecord> record_;
};

}  // namespace lf::app
