// The newest that the control and vision threads said of themselves. Collected from their rings by a thread that nothing blocks, so that a slow disk never
// hides how things stand.
#pragma once

#include <functional>
#include <mutex>

#include "hal/vehicle/control_loop.hpp"
#include "hal/vehicle/status_json.hpp"
#include "hal/vehicle/vehicle_platform.hpp"

namespace lf::hal {

class StatusBoard {
 public:
  struct Newest {
    ControlReport control;
    CameraReport camera;
    Telemetry telemetry;
  };

  // All outlive the board.
  StatusBoard(LogRings& log, LoopRings& loops, const config::ErrorTexts& texts) : log_(log), loops_(loops), texts_(texts) {}

  // Takes what is in the rings; `tell` gets a line for each event and, at most twice a second, one for counters that have changed. One thread.
  void collect(Time now, const std::function<void(const Json&)>& tell);
  // From any thread.
  Newest newest() const;

 private:
  void tell_counters(Time now, const std::function<void(const Json&)>& tell);

  LogRings& log_;
  LoopRings& loops_;
  const config::ErrorTexts& texts_;
  Json counters_;
  Time next_counters_;
  mutable std::mutex mutex_;  // over `newest_`, for as long as a copy takes
  Newest newest_;
};

}  // namespace lf::hal
