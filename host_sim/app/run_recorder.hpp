// Watches a run from outside the core: keeps its log, its digest, its curves and pictures, and scores what the core saw against the truth.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/scan_pipeline.hpp"
#include "firmware/telemetry.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/outside_pictures.hpp"
#include "host_sim/app/scoring.hpp"
#include "host_sim/record/candump_log.hpp"
#include "host_sim/record/cloud_file.hpp"
#include "host_sim/record/digest.hpp"
#include "host_sim/record/joint_log.hpp"
#include "host_sim/record/png.hpp"
#include "host_sim/record/report.hpp"
#include "host_sim/record/run_folder.hpp"

namespace lf::app {

struct TaskTruth {
  double valve_rad = 0;                                            // when the task ended
  std::array<std::uint32_t, PanelLayout::button_count> presses{};  // by then, counted by the buttons themselves
};

// What the core made of the panel at its first look, with what was true then.
struct Located {
  PanelResult panel;
  Pose base_from_panel = Pose::Identity();  // as found
  double handle_found_rad = 0;
  double handle_true_rad = 0;
  scene::BodyPoses poses;  // while it looked
  std::vector<CloudPoint> cloud;
};

class RunRecorder : public hal::SimObserver {
 public:
  using Say = std::function<void(const std::string&)>;  // a line of progress

  // `folder` may be null: then nothing is written while it runs. It outlives the recorder, as `say` does what it refers to.
  RunRecorder(const record::RunFolder* folder, const scene::Scene& scene, Say say);

  void on_bus_frame(const devices::BusRecord& record) override;
  void on_step(Time now, const world::World& world) override;
  void on_image(const hal::ExposureRecord& exposure) override;
  void on_telemetry(const Telemetry& telemetry) override;
  void on_panel_request(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) override;
  void on_panel_result(const PanelResult& result) override;

  // After each turn of the control thread, outside of its timing: where the panel was found, and the still's picture with the marker in it.
  void after_control(const mission::Mission& mission);
  // After each turn of the vision thread: the peaks of the newest laser-on image.
  void after_vision(const ScanPipeline& pipeline);
  // At the end of the run.
  void finish(const world::World& world, const std::string& failure);

  const std::vector<record::PhaseRecord>& phases() const { return phases_; }
  const std::vector<record::ReportChart> charts() const;
  std::vector<record::ReportPicture>& pictures() { return pictures_; }
  const std::vector<TaskTruth>& tasks() const { return tasks_; }
  const std::optional<Located>& located() const { return located_; }
  const PeakScore& peaks() const { return peaks_; }
  const PlaneFit& last_fit() const { return last_fit_; }
  // Draws the robot from outside and puts the pictures in front of the camera's.
  void draw_outside(const optics::OpticsConfig& optics, int threads);
  std::string digest() const { return digest_.hex(); }
  std::string stage() const { return phases_.empty() ? "boot" : phases_.back().name; }
  // Why something could not be written, if so: full disk.
  const std::string& write_error() const { return write_error_; }

 private:
  void on_event(const Event& event);
  void keep_picture(const std::string& name, const std::string& title, const std::string& caption, const record::RgbImage& image,
                    bool in_report);
  void keep_still();
  void sample_curves(const Telemetry& telemetry);

  const record::RunFolder* folder_;
  Say say_;
  scene::Scene scene_;
  std::optional<record::CandumpLog> can_log_;
  std::optional<record::JointLog> joint_log_;
  record::RunDigest digest_;
  std::vector<record::PhaseRecord> phases_;
  bool phase_retried_ = false;
  std::vector<record::ReportPicture> pictures_;
  std::vector<TaskTruth> tasks_;
  std::optional<Located> located_;
  bool map_taken_ = false;
  PeakScore peaks_;
  OutsidePictures outside_;
  PlaneFit last_fit_;
  std::string write_error_;

  const world::World* world_ = nullptr;
  const optics::Frame* frame_ = nullptr;  // the newest image, lent until the next
  Time frame_start_, frame_middle_;
  bool frame_has_laser_ = false;
  Time peaks_of_;
  std::uint32_t laser_frames_ = 0;

  std::vector<CloudPoint> asked_cloud_;
  scene::BodyPoses asked_poses_;
  double asked_valve_rad_ = 0;
  PanelResult answered_;
  std::optional<record::RgbImage> still_;  // until the answer says where the marker is in it
  bool still_answered_ = false;
  Time still_time_;

  std::uint64_t bus_bits_ = 0, bus_bits_before_ = 0;
  std::uint32_t ticks_ = 0;
  std::vector<double> t_s_;
  std::array<std::vector<double>, joint_count> target_rad_, actual_rad_, torque_nm_;
  std::vector<double> valve_deg_, bus_load_percent_;
};

}  // namespace lf::app
