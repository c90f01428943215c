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
  if (frame_ == nullptr || !has_laser_) return;
  const auto of_the_panel = [this](std::uint16_t object) { return object > panel_; };  // Frame::object is 1 + the body
  waiting_.push_back({frame_start_, frame_middle_, stripe_truth(*frame_, of_the_panel)});
  if (waiting_.size() > most_waiting) waiting_.pop_front();
}

bool PeakObserver::after_vision(const ScanPipeline& pipeline) {
  if (pipeline.stripes_taken() - taken_ > ScanPipeline::taken_kept) taken_ = pipeline.stripes_taken() - ScanPipeline::taken_kept;
  for (; taken_ != pipeline.stripes_taken(); ++taken_) {
    const auto [time, places_px] = pipeline.taken(taken_);
    for (const Waiting& stripe : waiting_) {
      if (time == stripe.middle || time == stripe.start) add(stripe.start, stripe.truth, places_px);
    }
  }
  if (frame_ == nullptr || !has_laser_ || pipeline.last_peaks_time() == peaks_of_) return false;
  peaks_of_ = pipeline.last_peaks_time();
  return peaks_of_ == frame_middle_ || peaks_of_ == frame_start_;  // and not of another image
}

void PeakObserver::add(Time start, const StripeTruth& truth, std::span<const Eigen::Vector2f> points) {
  const PeakScore before = score_;
  score_.add(truth, points);
  const auto visible = static_cast<double>(score_.visible() - before.visible());
  if (!t_s_.empty() && start.s() > t_s_.back() + pause_s) {
    t_s_.push_back(t_s_.back() + pause_s / 2);
    for (std::vector<double>* series : {&points_, &visible_, &false_, &recall_percent_}) series->push_back(record::unknown);
  }
  t_s_.push_back(start.s());
  points_.push_back(static_cast<double>(points.size()));
  visible_.push_back(visible);
  false_.push_back(static_cast<double>(score_.false_peaks() - before.false_peaks()));
  recall_percent_.push_back(visible > 0 ? 100 * static_cast<double>(score_.found() - before.found()) / visible : record::unknown);
}

std::vector<record::ReportChart> PeakObserver::charts() const {
  return {{"Each stripe of the sweeps",
           "columns",
           {{"peaks that became points", t_s_, points_, false},
            {"with a visible stripe (truth)", t_s_, visible_, true},
            {"false points (truth)", t_s_, false_, false}}},
          {"Recall of each stripe, truth", "%", {{"recall", t_s_, recall_percent_, false}}}};
}

}  // namespace lf::app
