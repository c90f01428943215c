// The simulated platform: physics, devices and camera in lockstep behind the ports.
//
// Simulated time is the only clock. `wait_for_tick` runs four steps of 1 ms and returns at once; images and panel-vision answers come out at fixed
// simulated latencies, whatever time their making takes: they are made on other threads meanwhile and joined at that simulated instant.
// The core reaches nothing of it but CAN frames and images; the observer sees everything, for the record and for scoring.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hal/ports.hpp"
#include "hal/sim/exposure_under_way.hpp"
#include "hal/sim/render_worker.hpp"
#include "hal/sim/sim_config.hpp"
#include "hal/sim/sim_faults.hpp"
#include "hal/vision/panel_vision.hpp"
#include "host_sim/devices/devices.hpp"
#include "host_sim/optics/optics.hpp"
#include "host_sim/world/world.hpp"

namespace lf::hal {

// An exposure with its image and what is true of it.
struct ExposureRecord {
  devices::Exposure exposure;  // its start as the time stamp has it
  std::uint32_t sequence = 0;
  scene::BodyPoses poses;  // at mid-exposure
  const optics::Frame* frame = nullptr;
};

// What a run leaves to be recorded, in the order of simulated time. All calls come from the thread that runs the platform.
class SimObserver {
 public:
  virtual ~SimObserver() = default;
  virtual void on_bus_frame(const devices::BusRecord&) {}
  virtual void on_step(Time, const world::World&) {}  // after every physics step
  virtual void on_image(const ExposureRecord&) {}
  virtual void on_telemetry(const Telemetry&) {}
  virtual void on_panel_request(const PanelRequest&, ImageView, std::span<const CloudPoint>) {}
  virtual void on_panel_result(const PanelResult&) {}
};

class SimPlatform : public Unattended {
 public:
  // `observer` outlives the platform. Throws InputError for a configuration that makes no sense.
  SimPlatform(const SimConfig& config, SimObserver& observer);

  PortStatus wait_for_tick(Time& tick);
  PortStatus receive_can(std::uint8_t bus, ReceivedFrame& received);
  PortStatus send_can(std::uint8_t bus, std::span<const CanFrame> frames);
  PortStatus receive_image(std::uint8_t camera, Image& image);
  PortStatus submit_panel(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud);
  PortStatus receive_panel(PanelResult& result);
  PortStatus publish(const Telemetry& telemetry);

  // What the operator orders in the scenario's faults.
  PortStatus receive_order(NumberedOrder& order);
  // False while the vision thread hangs: its turn is left out.
  bool vision_runs() const { return !faults_.on(SimFaultKind::vision_stalled); }
  // Another fault, besides the configured ones. Throws InputError for one of the devices that cannot be.
  void add_fault(const SimFault& fault) { faults_.add(fault); }
  // When the mission came to this step, by which faults at a step are timed.
  std::optional<Time> entered(mission::Step step) const { return faults_.entered(step); }

  // Something gets between the fingers, or behind them; see World::block_jaw.
  void block_jaw(double lower_rad, double upper_rad) { world_.block_jaw(lower_rad, upper_rad); }

  Time now() const { return now_; }
  const world::World& world() const { return world_; }  // ground truth: for scoring only
  devices::Devices& devices() { return devices_; }
  const devices::Devices& devices() const { return devices_; }

 private:
  struct PendingExposure {
    ExposureUnderWay under_way;
    RenderWorker::Ticket ticket = 0;
    bool submitted = false;
  };

  void step();
  void expose();
  void expose(PendingExposure& pending);
  void picture(const PendingExposure& exposure);
  bool spoil_image(Image& image);
  PanelResult see_as_it_is(const PanelRequest& request) const;
  void begin_faults();
  void begin(const SimFault& fault);

  SimConfig config_;
  SimObserver& observer_;
  world::World world_;
  devices::Devices devices_;
  std::unique_ptr<RenderWorker> renderer_;             // none where sight is given
  std::unique_ptr<vision::PanelVisionWorker> vision_;  // the same

  FaultSchedule faults_;
  std::deque<Command> orders_;
  std::uint32_t images_to_lose_ = 0;
  std::optional<Image> last_image_;
  std::vector<std::uint8_t> hanging_;  // the sensor's last picture, while it is frozen
  std::int32_t hanging_width_ = 0, hanging_height_ = 0;
  std::optional<PanelResult> given_answer_;

  Time now_;
  std::uint32_t exposures_ = 0;
  std::deque<PendingExposure> pending_;
  optics::Frame delivered_;  // its pixels are lent to the core until the next image
  std::optional<Time> vision_answer_due_;
};

}  // namespace lf::hal
