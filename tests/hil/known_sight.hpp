// A simulated platform whose sight is given, not rendered: what panel vision would answer is made of the world's truth. For tests of everything else:
// a mission without rendering takes a tenth of the time.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "firmware/config.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/sim/given_sight.hpp"
#include "hal/sim/sim_platform.hpp"

namespace lf::test {

class KnownSight : public hal::Unattended {
 public:
  // `inner` outlives this. `base_from_panel` is the true pose of the panel.
  KnownSight(hal::SimPlatform& inner, const ControllerConfig& told, const Pose& base_from_panel)
      : inner_(inner), camera_(told.camera), markers_(told.markers), layout_(told.mission.layout), base_from_panel_(base_from_panel) {}

  // Whether questions from now on are answered.
  void answer(bool answers) { answers_ = answers; }
  // From now on the panel is seen shifted by so much, in its own axes.
  void mistake(const Vec3& shift_m) { shift_m_ = shift_m; }
  // From now on the handle is seen turned by so much.
  void mistake_handle(double rad) { handle_rad_ = rad; }
  // So many of the pictures that come from now on get lost.
  void lose_images(std::uint32_t count) { images_to_lose_ = count; }
  // From now on the camera hands out the same picture: with its old number and stamp, or, when it is only the sensor that hangs, with new ones.
  enum class Frozen { no, camera, sensor };
  void freeze(Frozen frozen) { frozen_ = frozen; }

  hal::PortStatus wait_for_tick(Time& tick) { return inner_.wait_for_tick(tick); }
  hal::PortStatus receive_can(std::uint8_t bus, hal::ReceivedFrame& received) { return inner_.receive_can(bus, received); }
  hal::PortStatus send_can(std::uint8_t bus, std::span<const CanFrame> frames) { return inner_.send_can(bus, frames); }
  hal::PortStatus receive_image(std::uint8_t camera, Image& image);
  hal::PortStatus submit_panel(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud);
  hal::PortStatus receive_panel(PanelResult& result);
  hal::PortStatus publish(const Telemetry& telemetry) { return inner_.publish(telemetry); }

  std::uint32_t questions() const { return questions_; }

 private:
  hal::SimPlatform& inner_;
  CameraCalibration camera_;
  MarkerCalibrations markers_;
  PanelLayout layout_;
  Pose base_from_panel_;
  bool answers_ = true;
  Vec3 shift_m_ = Vec3::Zero();
  double handle_rad_ = 0;
  std::uint32_t images_to_lose_ = 0;
  Frozen frozen_ = Frozen::no;
  std::optional<Image> last_image_;
  std::vector<std::uint8_t> hanging_;  // the sensor's picture
  std::uint32_t questions_ = 0;
  std::optional<PanelResult> answer_;
  Time answer_due_;
};

static_assert(hal::Platform<KnownSight>);

using hal::panel_as_it_is;

}  // namespace lf::test
