#include "firmware/controller.hpp"

#include <cmath>

namespace lf {

Controller::Controller(const ControllerConfig& config) : network_(config.network), mission_(config) {}

void Controller::on_can(std::uint8_t bus, const CanFrame& frame, Time t) {
  if (bus >= bus_count) {
    ++rejected_inputs_;
    return;
  }
  network_.on_frame(frame, t);
}

void Controller::on_panel(const PanelResult& result, Time t) {
  bool valid = result.fit.plane.normal.allFinite() && std::isfinite(result.fit.plane.offset_m) && std::isfinite(result.confidence) &&
               result.measured <= t && result.clusters.size() <= PanelResult::max_clusters &&
               result.markers.size() <= PanelLayout::max_markers && result.pointers.size() <= PanelLayout::max_valves;
  for (std::size_t i = 0; valid && i < result.markers.size(); ++i) valid = result.markers[i].camera_from_tag.matrix().allFinite();
  if (!valid) {
    ++rejected_inputs_;
    return;
  }
  mission_.on_panel(result);
}

void Controller::on_scan(const ScanStats& stats, Time) { mission_.on_scan(stats); }

void Controller::on_port_error(Port port, std::int32_t, Time) {
  if (port >= Port::count) {
    ++rejected_inputs_;
    return;
  }
  ++port_errors_[static_cast<std::size_t>(port)];
  mission_.on_port_error(port);
}

bool Controller::on_order(const mission::Order& order, Time t) {
  const bool asks_for_power = order.command == Command::start || order.command == Command::home || order.command == Command::jog;
  const bool taken = (!asks_for_power || network_.may_have_power()) && mission_.order(order, t);
  orders_refused_ += taken ? 0 : 1;
  return taken;
}

bool Controller::on_command(Command command, Time t) {
  mission::Order order;
  order.command = command;
  return on_order(order, t);
}

void Controller::tick(Time t, TickOutput& out) {
  mission_.tick(t, network_, out.scan, out.telemetry);
  out.telemetry.rejected_inputs = rejected_inputs_ + network_.stats().refused_total();
  network_.tick(t, out.can[0]);
}

}  // namespace lf
