// The stripes that the core finds and takes for points, scored against the stripes as they were rendered.
#pragma once

#include <deque>
#include <vector>

#include "firmware/scan_pipeline.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/peak_score.hpp"
#include "host_sim/record/report.hpp"
#include "shared/scene/scene.hpp"

namespace lf::app {

class PeakObserver : public hal::SimObserver {
 public:
  // `panel`: the panel's body. The robot's bodies come before it.
  explicit PeakObserver(const PictureNoise& noise, scene::BodyId panel) : panel_(panel), score_(noise) {}

  void on_image(const hal::ExposureRecord& exposure) override;
  // After each turn of the vision thread. True when it has looked for peaks in the newest image.
  bool after_vision(const ScanPipeline& pipeline);

  const optics::Frame& frame() const { return *frame_; }  // the newest; lent until the next
  Time frame_start() const { return frame_start_; }
  // Of what became points: what the core throws out itself, outlines of its moving hand for the most, is no peak of the stripe to it.
  const PeakScore& score() const { return score_; }

  // Of each stripe of a sweep: what became points, and what of it could be seen.
  std::vector<record::ReportChart> charts() const;

 private:
  void add(Time start, const StripeTruth& truth, std::span<const Eigen::Vector2f> points);

  // A stripe waits for its joints.
  struct Waiting {
    Time start, middle;
    StripeTruth truth;
  };
  static constexpr std::size_t most_waiting = 32;

  scene::BodyId panel_;
  PeakScore score_;
  const optics::Frame* frame_ = nullptr;
  Time frame_start_, frame_middle_;
  bool has_laser_ = false;
  Time peaks_of_;
  std::uint32_t taken_ = 0;  // stripes that were scored, or came before the first picture
  std::deque<Waiting> waiting_;
  std::vector<double> t_s_, points_, visible_, false_, recall_percent_;
};

}  // namespace lf::app
