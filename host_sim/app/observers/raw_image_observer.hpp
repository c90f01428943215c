// --record-images: the camera's pictures as they are, each with its pose, for algorithms of the user's own.
//
// raw/images.jsonl has a JSON object a line. The first, "kind": "calibration", is what the core is told of camera and laser. Each of the others, "kind": "image",
// names a file, its exposure, what was lit, the joints at mid-exposure as the core read them, and the poses of camera and laser: `told` by calibration and
// joints, `true` in the simulator. An image of the laser names the one without it to subtract. Poses are rows of 4x4 matrices, in metres.
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <string>

#include "firmware/arm/kinematics.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/observers/run_files.hpp"
#include "host_sim/record/file_sink.hpp"
#include "shared/arm/joint_names.hpp"
#include "shared/calibration/calibration.hpp"

namespace lf::app {

class RawImageObserver : public hal::SimObserver {
 public:
  // `files` outlives the observer; where they are not wanted nothing is kept. `camera` and `laser` as the core is told, `optics` as it is.
  // `arm` and calibrations: as the core knows them.
  RawImageObserver(RunFiles& files, const arm::Arm& arm, const JointNames& names, const CameraCalibration& camera,
                   const LaserCalibration& laser, const optics::OpticsConfig& optics);

  void on_bus_frame(const devices::BusRecord& record) override;
  void on_telemetry(const Telemetry& telemetry) override;
  void on_image(const hal::ExposureRecord& exposure) override;
  void finish();

 private:
  struct Joints {
    Time t;
    PerJoint<double> rad{};
  };
  // At `t`, between the samples around it; the newest where none is later.
  PerJoint<double> joints_at(Time t) const;
  void say(const std::string& line);

  RunFiles& files_;
  arm::Arm arm_;
  JointNames names_;
  LaserCalibration laser_;
  Pose told_camera_, true_camera_;
  optics::LaserConfig true_laser_;
  std::optional<record::FileSink> list_;
  std::deque<Joints> joints_;  // of the last half second
  Time sync_;
  std::array<std::string, 2> newest_dark_;  // without the laser; with the lamps out, and lit
};

}  // namespace lf::app
