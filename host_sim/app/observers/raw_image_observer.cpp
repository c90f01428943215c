#include "host_sim/app/observers/raw_image_observer.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "firmware/arm/kinematics.hpp"
#include "firmware/canopen/cob_id.hpp"
#include "hal/config/event_json.hpp"
#include "host_sim/record/png.hpp"

namespace lf::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_joints = 128;  // half a second: a camera's latency is a quarter at most

Json matrix(const Pose& pose) {
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row) {
    Json numbers = Json::array();
    for (int column = 0; column < 4; ++column) numbers.push_back(pose.matrix()(row, column));
    rows.push_back(numbers);
  }
  return rows;
}

Json calibration(const CameraCalibration& camera, const LaserCalibration& laser) {
  const CameraIntrinsics& in = camera.intrinsics;
  return {{"kind", "calibration"},
          {"camera",
           {{"width", in.width},
            {"height", in.height},
            {"fx", in.fx},
            {"fy", in.fy},
            {"cx", in.cx},
            {"cy", in.cy},
            {"distortion", in.distortion},
            {"base_from_camera", matrix(camera.base_from_camera)}}},
          {"laser", {{"tool_from_laser", matrix(laser.tool_from_laser)}, {"fan_half_angle_rad", laser.fan_half_angle_rad}}}};
}

std::string file_name(const hal::ExposureRecord& exposure) {
  char name[64];
  std::snprintf(name, sizeof name, "raw/%06u_%s.png", exposure.sequence, exposure.exposure.laser ? "on" : "off");
  return name;
}

}  // namespace

RawImageObserver::RawImageObserver(RunFiles& files, const arm::Arm& arm, const JointNames& names, const CameraCalibration& camera,
                                   const LaserCalibration& laser, const optics::OpticsConfig& optics)
    : files_(files),
      arm_(arm),
      names_(names),
      laser_(laser),
      told_camera_(camera.base_from_camera),
      true_camera_(optics.cameras.at(0).base_from_camera),
      true_laser_(optics.lasers.at(0)) {
  if (!files_.wanted()) return;
  list_.emplace(files_.path("raw/images.jsonl"));
  say(calibration(camera, laser).dump());
}

// The drives answer each SYNC with where they stood at it.
void RawImageObserver::on_bus_frame(const devices::BusRecord& record) {
  if (record.frame.id == canopen::cob_id::sync) sync_ = record.delivered;
}

void RawImageObserver::on_telemetry(const Telemetry& telemetry) {
  joints_.push_back({sync_, telemetry.actual_rad});
  if (joints_.size() > most_joints) joints_.pop_front();
}

PerJoint<double> RawImageObserver::joints_at(Time t) const {
  if (joints_.empty()) return {};
  const auto after = std::find_if(joints_.begin(), joints_.end(), [t](const Joints& sample) { return sample.t >= t; });
  if (after == joints_.end()) return joints_.back().rad;
  if (after == joints_.begin() || after->t == (after - 1)->t) return after->rad;
  const Joints& before = *(after - 1);
  const double share = (t - before.t).s() / (after->t - before.t).s();
  PerJoint<double> rad{};
  for (std::size_t i = 0; i < rad.size(); ++i) rad[i] = before.rad[i] + share * (after->rad[i] - before.rad[i]);
  return rad;
}

void RawImageObserver::on_image(const hal::ExposureRecord& record) {
  if (!list_ || !files_.error().empty() || record.frame == nullptr || record.frame->pixels.empty() || record.frame->channels != 1) return;
  const optics::Frame& frame = *record.frame;
  const devices::Exposure& exposure = record.exposure;
  const std::string name = file_name(record);
  files_.write(name, record::encode_png(ImageView{frame.pixels.data(), frame.width, frame.height, frame.width}));

  const PerJoint<double> rad = joints_at(exposure.start + exposure.duration / 2);
  arm::JointVector q = arm::JointVector::Zero();
  for (std::size_t i = 0; i < arm_.arm_joints(); ++i) q[static_cast<Eigen::Index>(i)] = rad[i];
  Json line{{"kind", "image"},
            {"file", name},
            {"t_s", config::json_seconds(exposure.start)},
            {"exposure_us", 1e6 * exposure.duration.s()},
            {"trigger", exposure.counter},
            {"laser", exposure.laser},
            {"lamps", exposure.lamps}};
  std::string& dark = newest_dark_[exposure.lamps ? 1 : 0];
  if (exposure.laser) {
    line["off"] = dark.empty() ? Json(nullptr) : Json(dark);
  } else {
    dark = name;
  }
  for (std::size_t i = 0; i < names_.size(); ++i) line["joints_rad"][names_[i]] = rad[i];
  line["told"] = {{"base_from_camera", matrix(told_camera_)}, {"base_from_laser", matrix(arm_.base_from_laser(q, laser_))}};
  const Pose& body = record.poses[true_laser_.body];
  line["true"] = {{"base_from_camera", matrix(true_camera_)}, {"base_from_laser", matrix(body * true_laser_.body_from_laser)}};
  say(line.dump());
}

void RawImageObserver::say(const std::string& line) {
  if (list_ && !list_->write(line + "\n")) files_.lost(list_->error());
}

void RawImageObserver::finish() {
  if (list_ && !list_->close()) files_.lost(list_->error());
}

}  // namespace lf::app
