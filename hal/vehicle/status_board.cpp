#include "hal/vehicle/status_board.hpp"

#include "hal/config/event_json.hpp"

namespace lf::hal {

namespace {

constexpr Duration counters_every = Duration::from_ms(500);

}  // namespace

void StatusBoard::collect(Time now, const std::function<void(const Json&)>& tell) {
  for (Telemetry telemetry; log_.telemetry.pop(telemetry);) {
    for (const Event& event : telemetry.events) tell(config::event_json(event, texts_, telemetry.sight));
    const std::lock_guard lock(mutex_);
    newest_.telemetry = telemetry;
  }
  for (ControlReport report; loops_.reports.pop(report);) {
    const std::lock_guard lock(mutex_);
    newest_.control = report;
  }
  for (CameraReport report; loops_.cameras.pop(report);) {
    const std::lock_guard lock(mutex_);
    newest_.camera = report;
  }
  tell_counters(now, tell);
}

void StatusBoard::tell_counters(Time now, const std::function<void(const Json&)>& tell) {
  if (now < next_counters_) return;
  next_counters_ = now + counters_every;
  const Newest latest = newest();
  Json counters = counters_json(latest.control, latest.camera, latest.telemetry);
  counters.erase("images");  // those that arrive well are no news
  if (counters == counters_) return;
  counters_ = counters;
  tell({{"t_s", latest.control.t.s()}, {"kind", "counted"}, {"counters", counters}});
}

StatusBoard::Newest StatusBoard::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

}  // namespace lf::hal
