// The panel-vision worker: a still image and a cloud in, marker and proud clusters out. The same code on every platform.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hal/vision/marker_detector.hpp"
#include "hal/vision/panel_clusters.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/messages/image.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::vision {

struct PanelVisionConfig {
  CameraCalibration camera;
  MarkerCalibrations markers;
  MarkerDetectorConfig detector;
  PanelLayout panel;
  double region_margin_m = 0.025;  // the plate is looked for so far beyond its nominal outline: the worst docking error
  PanelClustersConfig clusters;

  double full_margin = 40;                 // a marker's decision margin that no longer limits the confidence
  double full_ambiguity = 2;               // the same for the ratio of the two poses' errors
  std::uint32_t full_cluster_points = 80;  // the same for the largest cluster: a handle seen by 3 stripes has so many
};

// One analysis. Never throws: what OpenCV, PCL or memory throw becomes confidence 0, and `failed` (if given) is set.
// The markers are those with the configured ids, in the order of the configuration; of the two poses of each, where the image cannot tell (ambiguity below `full_ambiguity`), the one
// whose z agrees better with the plane's normal. `measured` is the still's time; `answered` is left to the platform.
// Confidence is the smallest of: inlier ratio of the fit; of the marker that gives most, its margin over `full_margin` and a half to one as the ambiguity goes from 1 to
// `full_ambiguity`; points of the largest cluster over `full_cluster_points`. It is 0 when the fit is not valid, when a still was given and the
// no configured marker is in it, or when nothing is proud. Without a still (`has_still` false) the marker has no say.
PanelResult analyse_panel(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud, const PanelVisionConfig& config,
                          bool* failed = nullptr);

// Everything an analysis needs, copied.
struct PanelJob {
  PanelRequest request;
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::vector<std::uint8_t> still;  // 8-bit grey, width * height; empty without a still
  std::vector<CloudPoint> cloud;

  static PanelJob copy(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud);
};

// Runs analyse_panel in a thread of its own, one job at a time. Submitting and polling may happen on two different threads.
class PanelVisionWorker {
 public:
  struct Stats {
    std::uint32_t accepted = 0;
    std::uint32_t refused = 0;  // submitted while busy, or while the last answer was not fetched yet
    std::uint32_t answered = 0;
    std::uint32_t failed = 0;  // answers with confidence 0 because something threw
  };

  explicit PanelVisionWorker(const PanelVisionConfig& config);
  // Drops a job that has not started and waits for one that has.
  ~PanelVisionWorker();
  PanelVisionWorker(const PanelVisionWorker&) = delete;
  PanelVisionWorker& operator=(const PanelVisionWorker&) = delete;

  // False, and counted, when a job is running or its answer has not been fetched. Does not wait.
  bool submit(PanelJob job);
  // Fetches the answer if there is one. Wait-free.
  bool poll(PanelResult& result);
  // Waits for the answer of the submitted job: how a simulated platform joins the worker at the simulated instant. False without a job.
  bool wait(PanelResult& result);
  bool busy() const;
  Stats stats() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lf::vision
