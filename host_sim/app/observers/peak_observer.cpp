#include "host_sim/app/observers/peak_observer.hpp"

#include "shared/scene/scene.hpp"

namespace lf::app {
namespace {

// Frame::object is 1 + the body.
bool of_the_panel(std::uint16_t object) { return object > static_cast<std::uint16_t>(scene::BodyId::panel); }

}  // namespace

void PeakObserver::on_image(const hal::ExposureRecord& exposure) {
  frame_ = exposure.frame;
  frame_start_ = exposure.exposure.start;
  frame_middle_ = exposure.exposure.start + exposure.exposure.duration / 2;
  has_laser_ = exposure.exposure.laser;
  if (frame_ == nullptr || !has_laser_) return;
  waiting_.push_back({frame_start_, frame_middle_, stripe_truth(*frame_, of_the_panel)});
  if (waiting_.size() > most_waiting) waiting_.pop_front();
}

bool PeakObserver::after_vision(const ScanPipeline& pipeline) {
  if (pipeline.last_taken_time() != taken_of_) {
    taken_of_ = pipeline.last_taken_time();
    for (const Waiting& stripe : waiting_) {
      if (taken_of_ == stripe.middle || taken_of_ == stripe.start) score_.add(stripe.truth, pipeline.last_taken());
    }
  }
  if (frame_ == nullptr || !has_laser_ || pipeline.last_peaks_time() == peaks_of_) return false;
  peaks_of_ = pipeline.last_peaks_time();
  return peaks_of_ == frame_middle_ || peaks_of_ == frame_start_;  // and not of another image
}

}  // namespace lf::app
