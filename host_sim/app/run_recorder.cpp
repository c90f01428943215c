#include "host_sim/app/run_recorder.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace lf::app {
namespace {

PictureNoise noise_of(const optics::OpticsConfig& optics) {
  PictureNoise noise;
  if (!optics.cameras.empty()) {
    const optics::CameraConfig& camera = optics.cameras.front();
    noise.read_grey = camera.gain * camera.read_noise_grey;
    noise.electrons_per_grey = camera.electrons_per_grey / std::max(camera.gain, 1e-9);
  }
  if (!optics.lasers.empty()) noise.speckle = optics.lasers.front().speckle;
  return noise;
}

}  // namespace

RunRecorder::RunRecorder(const record::RunFolder* folder, const config::ErrorTexts& texts, PhaseObserver::Say say,
                         const optics::OpticsConfig& optics, const arm::Arm& arm, const PanelNames& names)
    : files_(folder),
      bus_(files_, digest_),
      phases_(digest_, texts, std::move(say)),
      events_(files_, texts),
      curves_(files_, bus_, texts.names()),
      motion_(arm, texts.names(), names),
      panel_(files_),
      peaks_(noise_of(optics), scene::own_bodies(optics.scene).panel()),
      pictures_(files_) {}

void RunRecorder::keep_raw_images(const arm::Arm& arm, const JointNames& joints, const CameraCalibration& camera,
                                  const LaserCalibration& laser, const optics::OpticsConfig& optics) {
  all_.add(raw_images_.emplace(files_, arm, joints, camera, laser, optics));
}

void RunRecorder::after_control(const mission::Mission& mission) {
  pictures_.after_control();
  panel_.after_control(mission);
}

void RunRecorder::after_vision(const ScanPipeline& pipeline) {
  if (peaks_.after_vision(pipeline)) pictures_.on_peaks(peaks_.frame(), peaks_.frame_start(), pipeline.last_peaks());
}

// What the arm did, what it did to the panel, what it saw, and what that took.
std::vector<record::ReportChart> RunRecorder::charts(const safety::Limits& limits) const {
  std::vector<record::ReportChart> charts = curves_.joint_charts(limits);
  for (record::ReportChart& chart : motion_.charts()) charts.push_back(std::move(chart));
  for (record::ReportChart& chart : peaks_.charts()) charts.push_back(std::move(chart));
  charts.push_back(curves_.bus_chart());
  return charts;
}

void RunRecorder::finish(const world::World& world, const std::string& failure) {
  phases_.finish(world.time_s(), failure);
  char state[24];
  std::snprintf(state, sizeof state, "%016llx", static_cast<unsigned long long>(world.state_digest()));
  digest_.decision(Time::from_s(world.time_s()), std::string("final state ") + state);
  digest_.decision(Time::from_s(world.time_s()), "ended: " + failure);
  bus_.finish();
  curves_.finish();
  events_.finish();
  if (raw_images_) raw_images_->finish();
}

}  // namespace lf::app
