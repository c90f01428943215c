#include "host_sim/app/run_recorder.hpp"

#include <cstdio>
#include <iterator>

#include "shared/can/can_map.hpp"

namespace lf::app {

namespace {

constexpr std::uint32_t ticks_a_sample = 10;    // curves at 25 Hz
constexpr std::uint32_t frames_a_picture = 20;  // a sweep has about 230 stripes
constexpr std::uint32_t frames_a_report_picture = 60;
constexpr std::array<const char*, joint_count> joint_names{"slew", "shoulder", "elbow", "roll", "jaw"};

std::string formatted(const char* format, double a, double b = 0) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

ImageView view_of(const optics::Frame& frame) { return {frame.pixels.data(), frame.width, frame.height, frame.width}; }

// Without stuffing, which the load shown over time does not need to the bit.
std::uint64_t nominal_bits(const CanFrame& frame) { return 47u + 8u * frame.length; }

}  // namespace

RunRecorder::RunRecorder(const record::RunFolder* folder, const scene::Scene& scene, Say say)
    : folder_(folder), say_(std::move(say)), scene_(scene) {
  if (folder_ == nullptr) return;
  can_log_.emplace(folder_->file("can0.log"));
  joint_log_.emplace(folder_->file("joints.csv"));
}

void RunRecorder::on_bus_frame(const devices::BusRecord& record) {
  const bool from_core = record.sender == can_map::master_node;
  digest_.can_frame(record.delivered, 0, from_core ? record::CanDirection::to_devices : record::CanDirection::to_core, record.frame);
  bus_bits_ += nominal_bits(record.frame);
  if (can_log_ && !can_log_->write(record.delivered, record.frame) && write_error_.empty()) write_error_ = can_log_->sink().error();
}

void RunRecorder::on_step(Time now, const world::World& world) {
  world_ = &world;
  outside_.on_step(now, world);
}

void RunRecorder::on_image(const hal::ExposureRecord& exposure) {
  frame_ = exposure.frame;
  frame_start_ = exposure.exposure.start;
  frame_middle_ = exposure.exposure.start + exposure.exposure.duration / 2;
  frame_has_laser_ = exposure.exposure.laser;
}

void RunRecorder::on_telemetry(const Telemetry& telemetry) {
  for (const Event& event : telemetry.events) on_event(event);
  if (ticks_++ % ticks_a_sample == 0) sample_curves(telemetry);
}

void RunRecorder::sample_curves(const Telemetry& telemetry) {
  if (joint_log_ && !joint_log_->write(telemetry) && write_error_.empty()) write_error_ = joint_log_->sink().error();
  t_s_.push_back(telemetry.t.s());
  for (std::size_t i = 0; i < joint_count; ++i) {
    target_rad_[i].push_back(telemetry.target_rad[i]);
    actual_rad_[i].push_back(telemetry.actual_rad[i]);
    torque_nm_[i].push_back(telemetry.torque_nm[i]);
  }
  valve_deg_.push_back(world_ != nullptr ? deg_from_rad(world_->valve_angle_rad()) : record::unknown);
  const double window_s = ticks_a_sample * can_map::sync_period.s();
  bus_load_percent_.push_back(100.0 * static_cast<double>(bus_bits_ - bus_bits_before_) / (window_s * can_map::bitrate));
  bus_bits_before_ = bus_bits_;
}

void RunRecorder::on_event(const Event& event) {
  outside_.on_event(event);
  const mission::StepRow& step = mission::row(event.step);
  char text[160];
  std::snprintf(text, sizeof text, "%d %s %s %s %d %d %.17g", int(event.kind), step.name,
                event.fault == safety::Fault::count ? "-" : safety::name(event.fault), safety::name(event.reaction), event.task, event.code,
                event.value);
  digest_.decision(event.t, text);
  switch (event.kind) {
    case Event::Kind::step:
      if (event.step == mission::Step::next_task && !phases_.empty()) break;  // a decision of one tick
      if (phases_.empty() || phases_.back().name != step.stage) {
        if (!phases_.empty()) {
          phases_.back().end_s = event.t.s();
          phases_.back().outcome = phase_retried_ ? "retried" : "done";
          if (say_) say_(formatted("%7.2f s  ", phases_.back().end_s) + phases_.back().name + ": " + phases_.back().outcome);
        }
        phases_.push_back({step.stage, event.t.s(), record::unknown, ""});
        phase_retried_ = false;
      }
      break;
    case Event::Kind::fault:
      if (event.reaction >= safety::Reaction::retry) phase_retried_ = true;
      if (say_ && event.reaction >= safety::Reaction::retry) {
        say_(formatted("%7.2f s  ", event.t.s()) + step.name + ": " + safety::name(event.fault) +
             ", reaction: " + safety::name(event.reaction));
      }
      break;
    case Event::Kind::located:
      if (located_) break;
      located_ = Located{answered_, Pose::Identity(), event.value, asked_valve_rad_, asked_poses_, std::move(asked_cloud_)};
      break;
    case Event::Kind::task_done:
    case Event::Kind::task_failed: {
      TaskTruth truth;
      if (world_ != nullptr) {
        truth.valve_rad = world_->valve_angle_rad();
        for (std::size_t i = 0; i < truth.presses.size(); ++i) truth.presses[i] = world_->button(i).presses;
      }
      if (tasks_.size() <= event.task) tasks_.resize(event.task + 1u, truth);
      tasks_[event.task] = truth;
      break;
    }
  }
}

void RunRecorder::on_panel_request(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) {
  last_fit_ = request.fit;
  asked_cloud_.assign(cloud.begin(), cloud.end());
  if (world_ != nullptr) {
    asked_poses_ = world_->base_from_body();
    asked_valve_rad_ = world_->valve_angle_rad();
  }
  if (folder_ != nullptr && !cloud.empty() && !located_ && write_error_.empty()) {
    try {
      folder_->write("cloud.pcd", record::pcd_bytes(cloud));
    } catch (const record::RecordError& error) {
      write_error_ = error.what();
    }
  }
  still_.reset();
  still_answered_ = false;
  if (folder_ == nullptr || !request.has_still || !still.valid()) return;
  still_ = record::rgb_from_grey(still);
  still_time_ = request.still_time;
}

void RunRecorder::on_panel_result(const PanelResult& result) {
  answered_ = result;
  still_answered_ = true;
}

void RunRecorder::keep_still() {
  if (answered_.marker.found) {
    std::array<record::PixelPoint, 4> corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      corners[i] = {static_cast<float>(answered_.marker.corners_px[i].x()), static_cast<float>(answered_.marker.corners_px[i].y())};
    }
    record::draw_outline(*still_, corners, {255, 40, 40});
  }
  char name[64];
  std::snprintf(name, sizeof name, "images/still_%07.2fs.png", still_time_.s());
  keep_picture(name, formatted("Still image at %.2f s", still_time_.s()),
               answered_.marker.found ? "The marker as it was found, in red." : "No marker was found in it.", *still_, true);
  still_.reset();
}

void RunRecorder::after_control(const mission::Mission& mission) {
  if (still_ && still_answered_) keep_still();
  if (!located_ || map_taken_) return;
  located_->base_from_panel = mission.map().base_from_panel();
  map_taken_ = true;
}

void RunRecorder::after_vision(const ScanPipeline& pipeline) {
  if (frame_ == nullptr || !frame_has_laser_ || pipeline.last_peaks_time() == peaks_of_) return;
  peaks_of_ = pipeline.last_peaks_time();
  if (peaks_of_ != frame_middle_ && peaks_of_ != frame_start_) return;  // of another image
  peaks_.add(*frame_, pipeline.last_peaks());
  if (laser_frames_++ % frames_a_picture != 0) return;
  std::vector<record::PixelPoint> points;
  for (const scan::Peak& peak : pipeline.last_peaks()) points.push_back({peak.u_px, peak.v_px});
  char name[64];
  std::snprintf(name, sizeof name, "images/stripe_%07.2fs.png", frame_start_.s());
  keep_picture(name, formatted("Stripe at %.2f s", frame_start_.s()),
               formatted("%.0f peaks, red over the image.", static_cast<double>(points.size())),
               record::overlay_peaks(view_of(*frame_), points, 2.0f), (laser_frames_ - 1) % frames_a_report_picture == 0);
}

void RunRecorder::keep_picture(const std::string& name, const std::string& title, const std::string& caption, const record::RgbImage& image,
                               bool in_report) {
  if (folder_ == nullptr) return;
  std::vector<std::uint8_t> png = record::encode_png(image);
  if (write_error_.empty()) {
    try {
      folder_->write(name, png);
    } catch (const record::RecordError& error) {
      write_error_ = error.what();
    }
  }
  constexpr std::size_t most_in_report = 12;  // 100 kB each: the report stays within 4 MB
  if (in_report && pictures_.size() < most_in_report) pictures_.push_back({title, caption, std::move(png)});
}

void RunRecorder::draw_outside(const optics::OpticsConfig& optics, int threads) {
  if (folder_ == nullptr) return;
  std::vector<record::ReportPicture> camera = std::move(pictures_);
  pictures_.clear();
  for (const OutsidePictures::Picture& picture : outside_.draw(optics, threads)) {
    keep_picture("images/" + picture.name + ".png", picture.title, "Drawn after the run from its poses; the core never sees it.",
                 picture.image, true);
  }
  std::move(camera.begin(), camera.end(), std::back_inserter(pictures_));
}

void RunRecorder::finish(const world::World& world, const std::string& failure) {
  if (!phases_.empty()) {
    phases_.back().end_s = world.time_s();
    phases_.back().outcome = failure.empty() ? (phase_retried_ ? "retried" : "done") : "failed";
  }
  char state[24];
  std::snprintf(state, sizeof state, "%016llx", static_cast<unsigned long long>(world.state_digest()));
  digest_.decision(Time::from_s(world.time_s()), std::string("final state ") + state);
  digest_.decision(Time::from_s(world.time_s()), "ended: " + failure);
  if (can_log_ && !can_log_->close() && write_error_.empty()) write_error_ = can_log_->sink().error();
  if (joint_log_ && !joint_log_->close() && write_error_.empty()) write_error_ = joint_log_->sink().error();
}

const std::vector<record::ReportChart> RunRecorder::charts() const {
  record::ReportChart positions{"Joint positions", "rad", {}}, torques{"Joint torques", "N m", {}};
  for (std::size_t i = 0; i < joint_count; ++i) {
    positions.series.push_back({joint_names[i], t_s_, actual_rad_[i], false});
    positions.series.push_back({std::string(joint_names[i]) + ", target", t_s_, target_rad_[i], true});
    torques.series.push_back({joint_names[i], t_s_, torque_nm_[i], false});
  }
  return {positions,
          torques,
          {"Valve, true angle", "deg", {{"valve", t_s_, valve_deg_, false}}},
          {"Bus load", "%", {{"can0", t_s_, bus_load_percent_, false}}}};
}

}  // namespace lf::app
