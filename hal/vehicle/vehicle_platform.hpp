// The vehicle as a platform: SocketCAN, a camera, the kernel's clock, panel vision on its own thread, and a writer that takes what is to be kept.
//
// Which thread calls which port: hal/ports.hpp. The rest is the daemon's: opening, and what is to be reported.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>

#include "hal/ports.hpp"
#include "hal/vehicle/control_loop.hpp"
#include "hal/vehicle/control_report.hpp"
#include "hal/vehicle/estop_input.hpp"
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
  // All outlive the platform.
  VehiclePlatform(const VehicleConfig& config, LogRings& log, LoopRings& loops, const EstopLine& estop, LinuxCalls& calls = linux_calls());
  ~VehiclePlatform() override = default;
  VehiclePlatform(const VehiclePlatform&) = delete;
  VehiclePlatform& operator=(const VehiclePlatform&) = delete;

  PortStatus open_bus() { return can_.open(); }
  // 0, or errno with its explanation in `why`.
  PortStatus open_camera(std::string& why);

  PortStatus wait_for_tick(Time& tick);
  PortStatus receive_order(NumberedOrder& order);
  PortStatus answer_order(const OrderAnswer& answer);
  PortStatus read_estop(bool& closed) const;
  PortStatus receive_can(std::uint8_t bus, ReceivedFrame& received);
  PortStatus send_can(std::uint8_t bus, std::span<const CanFrame> frames);
  PortStatus receive_panel(PanelResult& result);
  PortStatus publish(const Telemetry& telemetry);

  PortStatus wait_for_image();  // 5 ms at most
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
  LoopRings& loops_;
  const EstopLine& estop_;
  SocketCan can_;
  TickClock clock_;
  bool clock_runs_ = false;
  std::variant<std::monostate, std::unique_ptr<V4l2Camera>, std::unique_ptr<RingCamera>> camera_;
  vision::PanelVisionWorker panel_vision_;
  PortStatus send_error_ = port_ok;  // of a frame that was tried again between two ticks
  PortStatus camera_status_ = port_empty;
};

static_assert(Platform<VehiclePlatform>);

}  // namespace lf::hal
