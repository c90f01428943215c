#include "host_sim/serve/served_camera.hpp"

#include <algorithm>
#include <utility>

namespace lf::serve {

namespace {

constexpr Duration punctual = Duration::from_ms(2);

}  // namespace

void ServedCamera::expose(const devices::Exposure& exposure) {
  ++stats_.exposures;
  pending_.push_back({exposure, sequence_++});
}

void ServedCamera::submit(const Pending& pending, const scene::BodyPoses& poses, const Pace& pace) {
  PictureOrder order;
  order.poses = poses;
  order.info.start_ns = pace.clock_at(pending.exposure.start).ns();
  order.info.exposure_ns = pending.exposure.duration.ns();
  order.info.sequence = pending.sequence;
  order.info.trigger = pending.exposure.counter;
  order.info.flags = (pending.exposure.laser ? frame_laser : 0) | (pending.exposure.lamps ? frame_lamps : 0);
  if (!renderer_.submit(order)) ++stats_.not_rendered;
}

void ServedCamera::step(Time t, const scene::BodyPoses& poses, const Pace& pace) {
  if (trouble_ != CameraTrouble::none && t >= trouble_end_) set_trouble(CameraTrouble::none, t);
  target_.beat();
  while (!pending_.empty() && t + Pace::step / 2 >= pending_.front().exposure.start + pending_.front().exposure.duration / 2) {
    submit(pending_.front(), poses, pace);
    pending_.pop_front();
  }
  const Time clock = pace.clock_at(t);
  while (true) {
    if (!next_) {
      Picture picture;
      if (!renderer_.take(picture)) return;
      next_ = std::move(picture);
    }
    const Duration exposure = Duration::from_ns(next_->info.exposure_ns);
    if (clock < Time::from_ns(next_->info.start_ns) + std::max(latency_, exposure)) return;
    deliver(*next_, clock);
    next_.reset();
  }
}

void ServedCamera::deliver(Picture& picture, Time clock) {
  if (trouble_ != CameraTrouble::none) ++stats_.troubled;
  if (trouble_ == CameraTrouble::drop || trouble_ == CameraTrouble::away) return;
  if (trouble_ == CameraTrouble::freeze) {
    if (frozen_.empty()) frozen_ = last_pixels_.empty() ? picture.pixels : last_pixels_;
    picture.pixels = frozen_;
  }
  for (int copy = 0; copy < (trouble_ == CameraTrouble::repeat ? 2 : 1); ++copy) {
    if (target_.deliver(picture.info, picture.pixels)) {
      ++stats_.frames;
    } else {
      ++stats_.not_delivered;
    }
  }
  const Duration took = clock - Time::from_ns(picture.info.start_ns);
  if (took > latency_ + punctual) ++stats_.late;
  stats_.latency_ms.push_back(1e3 * took.s());
  last_pixels_ = std::move(picture.pixels);
}

void ServedCamera::set_trouble(CameraTrouble trouble, Time until) {
  if (trouble_ == CameraTrouble::away && trouble != CameraTrouble::away) target_.set_away(false);
  if (trouble == CameraTrouble::away && trouble_ != CameraTrouble::away) target_.set_away(true);
  trouble_ = trouble;
  trouble_end_ = until;
  frozen_.clear();
}

}  // namespace lf::serve
