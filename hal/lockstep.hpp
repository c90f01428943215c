// Core and platform taking turns on one thread: how the desktop runs, and the tests.
#pragma once

#include <memory>

#include "firmware/controller.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/core_loop.hpp"
#include "hal/ports.hpp"

namespace lf::hal {

// `ControlProbe` and `VisionProbe` have begin() and end(), called around the core's work in a control turn and around each image.
template <Platform P, class ControlProbe = NoProbe, class VisionProbe = NoProbe>
class Lockstep {
 public:
  Lockstep(P& platform, const ControllerConfig& controller, const ScanConfig& scan)
      : platform_(platform),
        controller_(std::make_unique<Controller>(controller)),
        pipeline_(std::make_unique<ScanPipeline>(scan)),
        rings_(std::make_unique<CoreRings>()) {}

  // One control period, and what vision has to do in it.
  void step() {
    (void)control_turn(platform_, *controller_, *rings_, out_, now_, control_probe_);
    vision_turn(platform_, *pipeline_, *rings_, vision_probe_,
                [this](Port port, PortStatus code) { controller_->on_port_error(port, code, now_); });
  }

  bool ended() const { return controller_->mission().outcome().ended; }
  Time now() const { return now_; }
  Controller& controller() { return *controller_; }
  const Controller& controller() const { return *controller_; }
  const ScanPipeline& pipeline() const { return *pipeline_; }
  ControlProbe& control_probe() { return control_probe_; }
  VisionProbe& vision_probe() { return vision_probe_; }

 private:
  P& platform_;
  std::unique_ptr<Controller> controller_;
  std::unique_ptr<ScanPipeline> pipeline_;  // some megabytes: not for the stack
  std::unique_ptr<CoreRings> rings_;
  TickOutput out_;
  Time now_;
  ControlProbe control_probe_;
  VisionProbe vision_probe_;
};

}  // namespace lf::hal
