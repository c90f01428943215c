#include "host_sim/serve/served_camera.hpp"

#include <utility>

namespace lf::serve {

namespace {

constexpr Duration punctual = Duration::from_ms(2);

}  // namespace

void ServedCamera::expose(const devices::Exposure& exposure) {
  ++stats_.exposures;
  pending_.emplace_back(exposure, sequence_++, exposure_delay_);
}

void ServedCamera::submit(const hal::ExposureUnderWay& exposure, const Pace& pace) {
  const devices::Exposure& ordered = exposure.ordered();
  PictureOrder order;
  order.shot = exposure.shot();
  order.info.start_ns = (pace.clock_at(ordered.start) + stamp_offset_).ns();
  order.info.exposure_ns = ordered.duration.ns();
  order.info.sequence = exposure.sequence();
  order.info.trigger = ordered.counter;
  order.info.flags = (ordered.laser ? frame_laser : 0) | (ordered.lamps ? frame_lamps : 0);
  if (!renderer_.submit(order)) ++stats_.not_rendered;
}

void ServedCamera::step(Time t, Outputs outputs, const scene::BodyPoses& poses, const Pace& pace) {
  if (trouble_ != CameraTrouble::none && t >= trouble_end_) set_trouble(CameraTrouble::none, t);
  target_.beat();
  for (hal::ExposureUnderWay& exposure : pending_) exposure.pass(t - Pace::step, t, outputs.laser, outputs.lamps, poses);
  while (!pending_.empty() && pending_.front().closed(t)) {
    submit(pending_.front(), pace);
    pending_.pop_front();
  }
  const Time clock = pace.clock_at(t);
  while (true) {
    if (!next_) {
      Picture picture;
      if (!renderer_.take(picture)) return;
      next_ = std::move(picture);
    }
    if (clock < Time::from_ns(next_->info.start_ns) + latency_) return;
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
