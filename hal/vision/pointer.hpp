// Which end of the handle's bar carries the pointer mark. A bar looks the same after half a turn; its paint does not.
//
// Paint shows in two independent readings: the grey level of the bar's faces in the still image, and the brightness of the laser's line on the bar.
// Along a bar the light falls off smoothly, and the paint's edge is a step at a known place. Each reading is fitted twice with a straight line and
// a step of the paint's sign, the step at either end; what the wrong end leaves unexplained over what the right one leaves is the evidence.
// A shadow's edge across the bar may look like paint in the still image, but not in the laser's brightness: then the two readings disagree, and the
// confidence is low.
#pragma once

#include <span>

#include "firmware/scan/panel_frame.hpp"
#include "shared/calibration/calibration.hpp"
#include "shared/messages/image.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/panel/panel_layout.hpp"

namespace lf::vision {

// Where the handle's bar is, as marker, plane and cloud say.
struct BarPlace {
  Pose base_from_panel = Pose::Identity();
  double angle_rad = 0;          // one of the two, half a turn apart
  Vec3 centre_m = Vec3::Zero();  // panel frame; of the visible points
};

// `still` may be invalid, `cloud` empty: what is missing gives no evidence. `valve.pointer` none, or a mark that covers half of the bar or more: nothing
// is seen. Never throws.
PointerObservation find_pointer(const BarPlace& bar, ImageView still, std::span<const CloudPoint> cloud, const CameraCalibration& camera,
                                const PanelLayout::Valve& valve);

// A value at a place along the bar, m from its middle toward the end under test.
struct BarSample {
  double along_m = 0;
  double value = 0;
  double weight = 0;
};

// Evidence in -1..1 for a step of `sign` at `edge_m` (positive) against one at `-edge_m`; 0 when neither explains the samples better.
// `floor` is the standard deviation of a sample that light, noise and grain account for.
double step_evidence(std::span<const BarSample> samples, double edge_m, double sign, double floor);

}  // namespace lf::vision
