// Watches a run from outside the core with one observer for each thing that is kept of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hal/sim/observers.hpp"
#include "host_sim/app/observers/bus_observer.hpp"
#include "host_sim/app/observers/calibration_observer.hpp"
#include "host_sim/app/observers/curve_observer.hpp"
#include "host_sim/app/observers/event_observer.hpp"
#include "host_sim/app/observers/motion_observer.hpp"
#include "host_sim/app/observers/panel_observer.hpp"
#include "host_sim/app/observers/peak_observer.hpp"
#include "host_sim/app/observers/phase_observer.hpp"
#include "host_sim/app/observers/picture_observer.hpp"
#include "host_sim/app/observers/raw_image_observer.hpp"
#include "host_sim/judge/truth.hpp"

namespace lf::app {

class RunRecorder {
 public:
  // `folder` may be null: then nothing is written while it runs. It outlives the recorder, as do `texts` and what `say` refers to.
  // `optics`: the simulator's, for what its noise allows. `arm`: as the core knows it.
  RunRecorder(const record::RunFolder* folder, const config::ErrorTexts& texts, PhaseObserver::Say say, const optics::OpticsConfig& optics,
              const arm::Arm& arm, const PanelNames& names);
  RunRecorder(const RunRecorder&) = delete;
  RunRecorder& operator=(const RunRecorder&) = delete;

  // Keeps the camera's pictures as they are; before the run.
  void keep_raw_images(const arm::Arm& arm, const JointNames& joints, const CameraCalibration& camera, const LaserCalibration& laser,
                       const optics::OpticsConfig& optics);

  hal::SimObserver& observer() { return all_; }
  // After each turn of the control thread and of the vision thread, outside of their timing.
  void after_control(const mission::Mission& mission);
  void after_vision(const ScanPipeline& pipeline);
  // At the end of the run.
  void finish(const world::World& world, const std::string& failure);

  const PhaseObserver& phases() const { return phases_; }
  const CurveObserver& curves() const { return curves_; }
  const MotionObserver& motion() const { return motion_; }
  const PanelObserver& panel() const { return panel_; }
  const CalibrationObserver& calibration() const { return calibration_; }
  const PeakScore& peaks() const { return peaks_.score(); }
  // `limits`: those of the mission, which the joints are drawn with.
  std::vector<record::ReportChart> charts(const safety::Limits& limits) const;
  const judge::TruthObserver& truth() const { return truth_; }
  PictureObserver& pictures() { return pictures_; }
  EventObserver& events() { return events_; }
  std::string digest() const { return digest_.hex(); }
  // Why something could not be written, if so: full disk.
  const std::string& write_error() const { return files_.error(); }

 private:
  RunFiles files_;
  record::RunDigest digest_;
  judge::TruthObserver truth_;
  BusObserver bus_;
  PhaseObserver phases_;
  EventObserver events_;
  CurveObserver curves_;
  MotionObserver motion_;
  PanelObserver panel_;
  CalibrationObserver calibration_;
  PeakObserver peaks_;
  PictureObserver pictures_;
  std::optional<RawImageObserver> raw_images_;
  hal::SimObservers all_{&truth_, &bus_, &phases_, &events_, &curves_, &motion_, &panel_, &calibration_, &peaks_, &pictures_};
};

}  // namespace lf::app
