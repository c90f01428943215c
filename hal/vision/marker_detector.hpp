// AprilTag markers in a grey image, and the pose of a square marker from its four corners.
//
// Detection is libapriltag's: on 491 murky underwater frames it found 1823 right tags and no wrong one (hamming 0, margin 10) where OpenCV's
// ArUco found 1676. The pose is OpenCV's: IPPE (Collins and Bartoli, IJCV 2014) gives both tilts that explain a square, each refined by
// Levenberg-Marquardt on the reprojection error.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/calibration/calibration.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/messages/image.hpp"

namespace lf::vision {

struct MarkerDetectorConfig {
  std::string family = "36h11";  // marker_families() has the names
  int max_hamming = 0;           // corrected bits; with 1, 38 wrong ids came with 491 murky frames of 16h5, with 0 one
  double decimate = 1;           // the search runs on an image so many times smaller; corners are found in full resolution
  double blur_sigma_px = 0;      // of the searched image
  double min_margin = 10;        // grey levels between the decoded bits and their thresholds; weaker ones are dropped
};

struct DetectedMarker {
  std::int32_t id = -1;
  int hamming = 0;
  double margin = 0;
  std::array<Vec2, 4> corners_px{};  // counter-clockwise from the bottom left corner of the marker, pixel centres at integers
  Vec2 centre_px = Vec2::Zero();     // where the diagonals cross
};

// The two poses that explain the corners, the better one first. Tag frame: x right, y up, z out of the marker.
struct MarkerPose {
  Pose camera_from_tag = Pose::Identity();
  double reprojection_rms_px = 0;
  bool has_second = false;
  Pose camera_from_tag_second = Pose::Identity();
  double second_rms_px = 0;

  // The second's error over the first's; 1 when both are perfect, large when the tilt is certain.
  double ambiguity() const;
  // The angle between the two; 0 without a second.
  double second_angle_rad() const;
};

class MarkerDetector {
 public:
  // Throws InputError for an unknown family or a parameter out of range: hamming 0..2, decimate 1..8, blur 0..10 px, margin >= 0.
  explicit MarkerDetector(const MarkerDetectorConfig& config);
  ~MarkerDetector();
  MarkerDetector(MarkerDetector&&) noexcept;
  MarkerDetector& operator=(MarkerDetector&&) noexcept;

  // Markers by ascending id, the one with the larger margin first among equal ids. One thread, deterministic. An invalid image has none.
  std::vector<DetectedMarker> detect(ImageView image);

  static const std::vector<std::string>& marker_families();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

// Pose of a marker whose black square has sides of `size_m`. None when the corners have no pose in front of the camera.
std::optional<MarkerPose> marker_pose(const std::array<Vec2, 4>& corners_px, double size_m, const CameraIntrinsics& camera);

}  // namespace lf::vision
