#include "host_sim/serve/render_rings.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <span>
#include <thread>

#include "hal/vehicle/linux_calls.hpp"
#include "host_sim/serve/come_first.hpp"
#include "shared/input_error.hpp"

namespace lf::serve {

namespace {

constexpr std::chrono::microseconds look_again{300};
// A picture that has not come by then is not coming: its renderer was started anew, or is not there.
constexpr Duration lost_after = Duration::from_ms(1000);

std::int64_t now_ns() { return hal::linux_calls().monotonic_ns(); }

}  // namespace

ExposurePayload pack(const optics::Shot& shot) {
  ExposurePayload payload;
  double* to = payload.poses.data();
  payload.bodies = std::min(shot.poses.size(), scene::max_bodies);
  for (const Pose& pose : std::span(shot.poses).first(payload.bodies)) {
    const Mat3 rotation = pose.linear();
    const Vec3 translation = pose.translation();
    std::copy_n(rotation.data(), 9, to);
    std::copy_n(translation.data(), 3, to + 9);
    to += 12;
  }
  payload.laser = static_cast<double>(shot.laser);
  payload.lamps = static_cast<double>(shot.lamps);
  payload.time_s = shot.time_s;
  return payload;
}

optics::Shot unpack(const RecordInfo& info, const ExposurePayload& payload) {
  optics::Shot shot;
  shot.frame_number = info.sequence;
  shot.exposure = Duration::from_ns(info.exposure_ns);
  shot.laser = static_cast<float>(payload.laser);
  shot.lamps = static_cast<float>(payload.lamps);
  shot.time_s = payload.time_s;
  const double* from = payload.poses.data();
  shot.poses.resize(std::min<std::uint64_t>(payload.bodies, scene::max_bodies), Pose::Identity());
  for (Pose& pose : shot.poses) {
    pose.linear() = Eigen::Map<const Mat3>(from);
    pose.translation() = Eigen::Map<const Vec3>(from + 9);
    from += 12;
  }
  return shot;
}

std::size_t exposure_ring_bytes() { return frame_ring_bytes(exposure_slots, sizeof(ExposurePayload)); }
std::size_t render_rings_bytes() { return exposure_ring_bytes() + frame_ring_bytes(camera_ring_slots, camera_ring_payload); }

MappedFile map_render_rings(const std::string& file) {
  MappedFile mapped;
  if (const int error = mapped.open(file, render_rings_bytes()); error != 0) {
    throw InputError(file + ": cannot be mapped: " + std::strerror(error));
  }
  return mapped;
}

RemoteRenderer::RemoteRenderer(const std::string& file)
    : file_(map_render_rings(file)), pictures_(std::as_bytes(file_.bytes().subspan(exposure_ring_bytes()))) {
  exposures_.open(file_.bytes().first(exposure_ring_bytes()), exposure_slots, sizeof(ExposurePayload));
}

void RemoteRenderer::forget_lost(std::int64_t start_ns) {
  while (!under_way_.empty() && start_ns - under_way_.front().start_ns > lost_after.ns()) under_way_.pop_front();
}

bool RemoteRenderer::submit(const PictureOrder& order) {
  forget_lost(order.info.start_ns);
  if (under_way_.size() >= most_pictures_under_way) return false;
  under_way_.push_back(order.info);
  RecordInfo info = order.info;
  info.kind = kind_exposure;
  const ExposurePayload payload = pack(order.shot);
  return exposures_.write(info, std::as_bytes(std::span(&payload, 1)), now_ns());
}

bool RemoteRenderer::take(Picture& picture) {
  picture.pixels.resize(camera_ring_payload);
  if (pictures_.take(picture.info, std::as_writable_bytes(std::span(picture.pixels))) != FrameRingReader::Answer::record) return false;
  picture.pixels.resize(std::min<std::size_t>(picture.info.bytes, camera_ring_payload));
  // They come in the order of their exposures: what was ordered before this one is lost.
  while (!under_way_.empty() && static_cast<std::int32_t>(picture.info.sequence - under_way_.front().sequence) >= 0) under_way_.pop_front();
  return true;
}

RenderServer render_frames(const optics::OpticsConfig& config, const std::string& file, bool (*stop)()) {
  MappedFile mapped = map_render_rings(file);
  FrameRingReader exposures(std::as_bytes(mapped.bytes().first(exposure_ring_bytes())));
  FrameRingWriter pictures;
  pictures.open(mapped.bytes().subspan(exposure_ring_bytes()));
  come_first();
  optics::Optics optics(config);
  optics::Frame frame;
  RenderServer server;
  while (!stop()) {
    RecordInfo info;
    ExposurePayload payload;
    if (exposures.take(info, std::as_writable_bytes(std::span(&payload, 1))) != FrameRingReader::Answer::record) {
      pictures.beat(now_ns());
      std::this_thread::sleep_for(look_again);
      continue;
    }
    if (info.kind != kind_exposure || info.bytes != sizeof payload) continue;
    const std::int64_t start = now_ns();
    optics.render(unpack(info, payload), frame);
    fill_size(info, frame);
    pictures.write(info, std::as_bytes(std::span(frame.pixels)), now_ns());
    server.render_ms.push_back(1e-6 * static_cast<double>(now_ns() - start));
    ++server.pictures;
  }
  server.missed = exposures.stats().missed;
  return server;
}

}  // namespace lf::serve
