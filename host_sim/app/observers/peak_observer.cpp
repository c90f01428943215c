#include "host_sim/app/observers/peak_observer.hpp"

namespace lf::app {

void PeakObserver::on_image(const hal::ExposureRecord& exposure) {
  frame_ = exposure.frame;
  frame_start_ = exposure.exposure.start;
  frame_middle_ = exposure.exposure.start + exposure.exposure.duration / 2;
  has_laser_ = exposure.exposure.laser;
}

bool PeakObserver::after_vision(const ScanPipeline& pipeline) {
  if (frame_ == nullptr || !has_laser_ || pipeline.last_peaks_time() == peaks_of_) return false;
  peaks_of_ = pipeline.last_peaks_time();
  if (peaks_of_ != frame_middle_ && peaks_of_ != frame_start_) return false;  // of another image
  score_.add(*frame_, pipeline.last_peaks());
  return true;
}

}  // namespace lf::app
