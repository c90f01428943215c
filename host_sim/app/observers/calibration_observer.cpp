#include "host_sim/app/observers/calibration_observer.hpp"

#include <cmath>

#include "hal/config/cause.hpp"

namespace lf::app {

void CalibrationObserver::on_telemetry(const Telemetry& telemetry) {
  const mission::CalibrationFit& fit = telemetry.sight.fit;
  if (telemetry.sight.look == look_ || !fit.known) return;
  look_ = telemetry.sight.look;
  if (!record_) record_.emplace();
  const double side_percent = 100 * static_cast<double>(fit.marker_side_error);
  if (!(std::abs(side_percent) <= std::abs(record_->marker_side_percent))) record_->marker_side_percent = side_percent;
  record_->marker_corners_mm = std::fmax(record_->marker_corners_mm, 1e3 * static_cast<double>(fit.marker_corners_m));
  record_->plane_bend_mm = std::fmax(record_->plane_bend_mm, 1e3 * static_cast<double>(fit.plane_bend_m));
  record_->panel_shift_mm = std::fmax(record_->panel_shift_mm, 1e3 * static_cast<double>(fit.panel_shift_m));
  // Doubted before all others, then by how far the side is off.
  const bool doubted = !config::calibration_cause(fit, {}).name.empty();
  const double over = std::abs(static_cast<double>(fit.marker_side_error)) / config::allowed_side_error(fit) + (doubted ? 1 : 0);
  if (over <= worst_) return;
  worst_ = over;
  worst_fit_ = fit;
}

}  // namespace lf::app
