// The pictures of a run: stills with the marker in them, stripes with their peaks, and the robot from outside.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/scan_pipeline.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/observers/outside_pictures.hpp"
#include "host_sim/app/observers/run_files.hpp"
#include "host_sim/record/png.hpp"
#include "host_sim/record/report.hpp"

namespace lf::app {

class PictureObserver : public hal::SimObserver {
 public:
  // Throws InputError where pictures are wanted and cannot be written: before anything is flown.
  explicit PictureObserver(RunFiles& files);

  void on_step(Time now, const world::World& world) override { outside_.on_step(now, world); }
  void on_telemetry(const Telemetry& telemetry) override;
  void on_panel_request(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) override;
  void on_panel_result(const PanelResult& result) override;
  // After each turn of the control thread, outside of its timing.
  void after_control();
  // Peaks were found in this image of the laser.
  void on_peaks(const optics::Frame& frame, Time start, std::span<const scan::Peak> peaks);

  // Draws the robot from outside and puts the pictures in front of the camera's.
  void draw_outside(const optics::OpticsConfig& optics, int threads);
  std::vector<record::ReportPicture>& pictures() { return pictures_; }

 private:
  void keep_still();
  void keep(const std::string& name, const std::string& title, const std::string& caption, const record::RgbImage& image, bool in_report);

  RunFiles& files_;
  OutsidePictures outside_;
  std::vector<record::ReportPicture> pictures_;
  std::uint32_t laser_frames_ = 0;
  std::optional<record::RgbImage> still_;  // until the answer says where the marker is in it
  Time still_time_;
  PanelResult answered_;
  bool still_answered_ = false;
};

}  // namespace lf::app
