// The stripes that the core finds and takes for points, scored against the stripes as they were rendered.
#pragma once

#include <deque>

#include "firmware/scan_pipeline.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/peak_score.hpp"

namespace lf::app {

class PeakObserver : public hal::SimObserver {
 public:
  explicit PeakObserver(const PictureNoise& noise) : score_(noise) {}

  void on_image(const hal::ExposureRecord& exposure) override;
  // After each turn of the vision thread. True when it has looked for peaks in the newest image.
  bool after_vision(const ScanPipeline& pipeline);

  const optics::Frame& frame() const { return *frame_; }  // the newest; lent until the next
  Time frame_start() const { return frame_start_; }
  // Of what became points: what the core throws out itself, outlines of its moving hand for the most, is no peak of the stripe to it.
  const PeakScore& score() const { return score_; }

 private:
  // A stripe waits for its joints.
  struct Waiting {
    Time start, middle;
    StripeTruth truth;
  };
  static constexpr std::size_t most_waiting = 32;

  PeakScore score_;
  const optics::Frame* frame_ = nullptr;
  Time frame_start_, frame_middle_;
  bool has_laser_ = false;
  Time peaks_of_, taken_of_;
  std::deque<Waiting> waiting_;
};

}  // namespace lf::app
