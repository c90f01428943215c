// What the control thread tells the vision thread. The answers come back as PanelResult (panel_vision.hpp).
#pragma once

#include <array>
#include <cstdint>

#include "shared/messages/joint_io.hpp"
#include "shared/messages/time.hpp"

namespace lf {

// The arm's joints at a SYNC, decoded from the drives' answers.
struct JointSample {
  Time t;
  PerArmJoint<double> q_rad{};
};

// Why an exposure was asked for.
enum class ExposureKind : std::uint8_t {
  laser_on,    // a stripe to be measured
  background,  // the same scene without the laser: serves the stripes around it
  still,       // lamps on, laser off: markers are looked for in it
  monitor,     // for the record only: nothing is measured in it
};

// One order to the scan pipeline, in the order of their times.
struct ScanCommand {
  enum class Kind : std::uint8_t {
    joint_sample,   // `joints`
    exposure,       // `exposure_start`, `exposure_kind`, `trigger`: an image with this start is coming
    begin_sweep,    // empties the cloud; `sweep` names what follows
    end_sweep,      // no stripe after this one belongs to `sweep`
    analyse,        // fit the plane to the cloud and hand plane, cloud and still image on; `sweep` comes back as PanelRequest::id
    drop_exposure,  // `exposure_start`: laser or lamps were not what was asked during it; the image is refused and counted
  };
  Kind kind = Kind::joint_sample;
  JointSample joints;
  Time exposure_start;
  ExposureKind exposure_kind = ExposureKind::laser_on;
  std::uint8_t trigger = 0;  // exposure: the output node's counter that asks for it
  std::uint32_t sweep = 0;
};

// How a picture as a whole is lit.
struct PictureLight {
  float mean_grey = 0;
  // Of squares of 8 pixels beside one another: the step in brightness that one in a hundred exceeds. Noise leaves below 2 of it and a shape's edge over 10;
  // turbid water hides the edges.
  float contrast_grey = 0;
  float white_share = 0;  // of the pixels at full scale, 0..1
  float noise_grey = 0;   // standard deviation from pixel to pixel beside one another, where most of the picture is even
};

// The laser's stripe as the pictures since the sweep's begin have told it, up to the newest that shows the panel; all 0 before the first.
struct StripeForm {
  float width_px = 0;  // in the picture, as a standard deviation
  float lens_px = 0;   // the part of it that is the lens'
  float scatter = 0;   // once-scattered light over direct light
  float skew = 0;
  float speckle = 0;      // standard deviation of the light over its mean
  float model_share = 0;  // what its shape leaves unexplained, over its peak
};

// Counters of the vision side, never reset, and what it saw last.
struct ScanStats {
  std::uint32_t images = 0;             // measured: a stripe, a background or a still was taken from them
  std::uint32_t stripes = 0;            // of these, images of the laser in a sweep
  std::uint32_t stills = 0;             // of these, stills
  std::uint32_t images_unexpected = 0;  // no exposure was ordered at their time
  std::uint32_t images_refused = 0;     // malformed, stale, or dropped by order
  std::uint32_t images_missing = 0;     // exposures whose image did not come before the sweep's end
  std::uint32_t images_repeated = 0;    // the picture before once more: the camera is frozen
  std::uint32_t peaks = 0;
  std::uint32_t peaks_weak = 0;
  std::uint32_t peaks_saturated = 0;
  std::uint32_t peaks_ambiguous = 0;
  std::uint32_t peaks_unfitted = 0;  // no stripe could be fitted there
  std::uint32_t peaks_misfit = 0;    // what is there has no stripe's shape
  std::uint32_t peaks_apart = 0;     // too few columns in a row: no part of a line
  std::uint32_t points = 0;
  std::uint32_t points_overflowed = 0;  // the cloud was full
  std::uint32_t points_no_joints = 0;   // no joint samples around mid-exposure
  std::uint32_t commands_refused = 0;   // out of order, or not a number
  PictureLight still;                   // of the newest still
  StripeForm stripe;                    // as far as it is learned
  Time newest_exposure;                 // as ordered, of the newest image that came and was no repetition
};

}  // namespace lf
