// The peaks that the core finds, scored against the stripe as it was rendered.
#pragma once

#include <vector>

#include "firmware/scan_pipeline.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/scoring.hpp"
#include "host_sim/record/report.hpp"

namespace lf::app {

class PeakObserver : public hal::SimObserver {
 public:
  void on_image(const hal::ExposureRecord& exposure) override;
  // After each turn of the vision thread. True when it has looked for peaks in the newest image.
  bool after_vision(const ScanPipeline& pipeline);

  const optics::Frame& frame() const { return *frame_; }  // the newest; lent until the next
  Time frame_start() const { return frame_start_; }
  const PeakScore& score() const { return score_; }

  // Of each image of the laser: peaks, and what of the stripe was seen.
  std::vector<record::ReportChart> charts() const;

 private:
  PeakScore score_;
  const optics::Frame* frame_ = nullptr;
  Time frame_start_, frame_middle_;
  bool has_laser_ = false;
  Time peaks_of_;
  std::vector<double> t_s_, peaks_, visible_, false_, recall_percent_;
};

}  // namespace lf::app
