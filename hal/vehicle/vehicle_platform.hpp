// The vehicle as a platform: SocketCAN, a camera, the kernel's clock, panel vision on its own thread, and a writer that takes what is to be kept.
//
// Control thread: wait_for_tick, receive_can, send_can, receive_panel, publish. Vision thread: wait_for_image, receive_image, submit_panel.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>

#include "hal/ports.hpp"
#include "hal/vehicle/control_report.hpp"
#include "hal/vehicle/ring_camera.hpp"
#include "hal/vehicle/socket_can.hpp"
#include "hal/vehicle/tick_clock.hpp"
#include "hal/vehicle/v4l2_camera.hpp"
#include "hal/vehicle/vehicle_config.hpp"
#include "hal/vision/panel_vision.hpp"
#include "shared/messages/spsc_ring.hpp"

namespace lf::hal {

struct LogFrame {
  CanFrame frame;
  Time t;
  bool sent = false;
};

// From the control thread to the writer. 2 s of a full tick's frames: a disk that is slow for longer loses frames, and they are counted.
struct LogRings {
  SpscRing<LogFrame, 16384> frames;
  SpscRing<Telemetry, 256> telemetry;
};

class VehiclePlatform : private CanTap {
 public:
  VehiclePlatform(const VehicleConfig& config, LogRings& log, LinuxCalls& calls = linux_calls());
  ~VehiclePlatform() override = default;
  VehiclePlatform(const VehiclePlatform&) = delete;
  VehiclePlatform& operator=(const VehiclePlatform&) = delete;

  PortStatus open_bus() { return can_.open(); }
  // 0, or errno with its explanation in `why`.
  PortStatus open_camera(std::string& why);

  void start_clock() { clock_.start(); }
  PortStatus wait_for_tick(Time& tick);
  PortStatus receive_can(std::uint8_t bus, ReceivedFrame& received);
  PortStatus send_can(std::uint8_t bus, std::span<const CanFrame> frames);
  PortStatus receive_panel(PanelResult& result);
  PortStatus publish(const Telemetry& telemetry);

  // Blocks until there may be an image, 5 ms at most.
  void wait_for_image();
  PortStatus receive_image(std::uint8_t camera, Image& image);
  PortStatus submit_panel(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud);

  SocketCan& can() { return can_; }
  const SocketCan& can() const { return can_; }
  const TickClock& clock() const { return clock_; }
  CameraReport camera_report() const;  // on the vision thread
  const LogRings& log() const { return log_; }

 private:
  void on_frame(const CanFrame& frame, Time t, bool sent) override;

  const VehicleConfig& config_;
  LinuxCalls& calls_;
  LogRings& log_;
  SocketCan can_;
  TickClock clock_;
  std::variant<std::monostate, std::unique_ptr<V4l2Camera>, std::unique_ptr<RingCamera>> camera_;
  vision::PanelVisionWorker panel_vision_;
  PortStatus send_error_ = port_ok;  // of a frame that was tried again between two ticks
  PortStatus camera_status_ = port_empty;
};

static_assert(Platform<VehiclePlatform>);

}  // namespace lf::hal
