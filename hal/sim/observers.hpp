// Several observers of one run, told one after the other.
#pragma once

#include <initializer_list>
#include <span>
#include <vector>

#include "hal/sim/sim_platform.hpp"

namespace lf::hal {

class SimObservers : public SimObserver {
 public:
  // All outlive this; they are told in this order.
  SimObservers(std::initializer_list<SimObserver*> all) : all_(all) {}
  void add(SimObserver& observer) { all_.push_back(&observer); }

  void on_bus_frame(const devices::BusRecord& record) override {
    for (SimObserver* each : all_) each->on_bus_frame(record);
  }
  void on_step(Time now, const world::World& world) override {
    for (SimObserver* each : all_) each->on_step(now, world);
  }
  void on_image(const ExposureRecord& exposure) override {
    for (SimObserver* each : all_) each->on_image(exposure);
  }
  void on_telemetry(const Telemetry& telemetry) override {
    for (SimObserver* each : all_) each->on_telemetry(telemetry);
  }
  void on_panel_request(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) override {
    for (SimObserver* each : all_) each->on_panel_request(request, still, cloud);
  }
  void on_panel_result(const PanelResult& result) override {
    for (SimObserver* each : all_) each->on_panel_result(result);
  }

 private:
  std::vector<SimObserver*> all_;
};

}  // namespace lf::hal
