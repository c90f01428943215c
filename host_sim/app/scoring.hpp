// How well the core saw, against the simulator's truth. Nothing of it goes back into the core.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "firmware/scan/peaks.hpp"
#include "host_sim/optics/optics.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/panel/panel_layout.hpp"
#include "shared/scene/scene.hpp"

namespace lf::app {

// Angle between the normals, deg, whichever way they point.
double plane_normal_error_deg(const Plane& found, const Pose& true_base_from_panel);
// Distance of the true plate's centre from the found plane, mm.
double plane_offset_error_mm(const Plane& found, const Pose& true_base_from_panel, const PanelLayout& layout);
// Of a bar, which is the same after half a turn: -90 to 90 deg, absolute.
double handle_error_deg(double found_rad, double true_rad);

// Distance of a point from a shape's surface, both in the body's frame. A capsule is its cylinder and two half spheres; a mesh its triangles.
double distance_to_surface_m(const Vec3& point_m, const scene::Shape& shape);
// Distances of the points from the nearest surface of panel, handle and buttons, mm.
std::vector<double> cloud_errors_mm(std::span<const CloudPoint> cloud, const scene::Scene& scene, const scene::BodyPoses& poses);

// Detected peaks against the stripe as it was rendered, over all frames of a run.
class PeakScore {
 public:
  // A column counts as seen when the stripe stands at least so high over the background; less is under three times the worst noise of 3 grey levels.
  static constexpr float visible_grey = 10.0f;
  // Farther off than this from each piece of the stripe a peak is another thing.
  static constexpr double match_px = 2.0;
  // A lens lays a piece's light into the columns beside it: a peak there is of that piece, though its own column has none.
  static constexpr std::int32_t beside_px = 2;

  void add(const optics::Frame& truth, std::span<const scan::Peak> peaks);
  double rms_px() const;  // of peaks on a piece of their column; NaN without any
  // Of matched peaks whose stripe lies on one smooth surface: at a silhouette, a crease or a shadow's end the light itself is no longer even about its
  // true centre. NaN without any, or without depth in the truth.
  double smooth_rms_px() const;
  double recall() const;           // columns whose brightest piece was found, over the visible ones; NaN without any
  double false_share() const;      // peaks on no piece of the stripe, over all peaks; NaN without any
  double elsewhere_share() const;  // visible columns of which another piece was found and the brightest was not; NaN without any
  std::uint64_t visible() const { return visible_; }
  std::uint64_t found() const { return found_; }  // of these, those whose brightest piece was found
  std::uint64_t false_peaks() const { return false_; }

 private:
  std::uint64_t visible_ = 0, found_ = 0, elsewhere_ = 0, peaks_ = 0, matched_ = 0, false_ = 0, smooth_ = 0;
  double squares_ = 0, smooth_squares_ = 0;
};

// Nearest-rank percentile, NaN without values.
double percentile(std::vector<double> values, double share);

}  // namespace lf::app
