#include "host_sim/app/observers/peak_observer.hpp"

namespace lf::app {

namespace {

constexpr double pause_s = 1;  // longer than any interval of the camera's, twice 80 ms: charts show no line over it

}  // namespace

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
  const PeakScore before = score_;
  score_.add(*frame_, pipeline.last_peaks());
  const auto visible = static_cast<double>(score_.visible() - before.visible());
  if (!t_s_.empty() && frame_start_.s() > t_s_.back() + pause_s) {
    t_s_.push_back(t_s_.back() + pause_s / 2);
    for (std::vector<double>* series : {&peaks_, &visible_, &false_, &recall_percent_}) series->push_back(record::unknown);
  }
  t_s_.push_back(frame_start_.s());
  peaks_.push_back(static_cast<double>(pipeline.last_peaks().size()));
  visible_.push_back(visible);
  false_.push_back(static_cast<double>(score_.false_peaks() - before.false_peaks()));
  recall_percent_.push_back(visible > 0 ? 100 * static_cast<double>(score_.found() - before.found()) / visible : record::unknown);
  return true;
}

std::vector<record::ReportChart> PeakObserver::charts() const {
  return {{"Peaks of each laser picture",
           "columns",
           {{"found by the core", t_s_, peaks_, false},
            {"with a visible stripe (truth)", t_s_, visible_, true},
            {"false (truth)", t_s_, false_, false}}},
          {"Recall of each laser picture, truth", "%", {{"recall", t_s_, recall_percent_, false}}}};
}

}  // namespace lf::app
