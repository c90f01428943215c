// One ray a pixel, computed once: distortion and a flat port then cost nothing a frame.
#pragma once

#include <optional>
#include <vector>

#include "host_sim/optics/lanes.hpp"
#include "host_sim/optics/optics.hpp"

namespace lf::optics {

// In the camera frame. The direction's z is 1, so a ray's parameter is the depth past its origin.
struct CameraRay {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();
};

// The normalised point (x, y at z = 1) that Brown-Conrady distortion takes to `distorted`, by Newton's method to 1e-13.
// nullopt where the distortion folds over, so that no such point is found.
std::optional<Vec2> undistort(const CameraIntrinsics& intrinsics, const Vec2& distorted);

// The ray in water that ends at image point (u, v). With a port: bent at both faces of the glass by Snell's law, starting on its wet face.
// nullopt where the distortion folds over or the port reflects totally.
std::optional<CameraRay> camera_ray(const CameraIntrinsics& intrinsics, const std::optional<FlatPort>& port, double u, double v);

// Eight rays side by side, in the base frame.
struct RayLines {
  Lanes3 origin, direction;
};

// The same with their change from one pixel to the next.
struct RayPacket : RayLines {
  Lanes3 origin_du, origin_dv;  // zero without a port
  Lanes3 direction_du, direction_dv;
};

// A camera's pose, ready for packets.
struct CameraPlace {
  explicit CameraPlace(const Pose& base_from_camera) : rotation(base_from_camera.linear()), position(base_from_camera.translation()) {}
  Rotation rotation;
  Lanes3 position;
};

class CameraRays {
 public:
  // Throws InputError where a pixel of the image has no ray.
  CameraRays(const CameraIntrinsics& intrinsics, const std::optional<FlatPort>& port);

  // The rays of pixels (u .. u + 7, v); u a multiple of eight; lanes past the right edge hold rays of their own that nobody needs.
  RayPacket row(const CameraPlace& place, int u, int v) const;

  RayLines lines(const CameraPlace& place, int u, int v) const;  // their lines only

  // row() moved down the image by up to a pixel, each lane by its own `offset_v`.
  RayPacket shifted_row(const CameraPlace& place, int u, int v, Lanes offset_v) const;

  // Eight rays through image points within about a pixel of pixel (u, v), each at its own offset.
  RayPacket around(const CameraPlace& place, int u, int v, Lanes offset_u, Lanes offset_v) const;

  // Where the image of a point in the camera frame is, px; nothing where it is behind the camera or well outside the image. Within 0.01 px inside of it.
  std::optional<Vec2> project(const Vec3& point_m) const;

  // Depth of the rays' origins along the camera's axis: 0 without a port.
  float origin_depth_m() const { return origin_z_; }

  // Range along a ray for each metre of its parameter.
  static Lanes slope(const RayLines& rays) { return norm(rays.direction); }

 private:
  // x and y of direction and origin over the image and one pixel more on each side.
  struct Node {
    std::vector<float> direction_x, direction_y, origin_x, origin_y;
  };
  std::size_t index(int u, int v) const { return static_cast<std::size_t>(v + 1) * stride_ + static_cast<std::size_t>(u + 1); }
  RayPacket to_base(const CameraPlace& place, const Lanes3& origin, const Lanes3& direction, const std::array<Lanes, 8>& slopes) const;

  std::size_t stride_ = 0;
  int width_ = 0, height_ = 0;
  double fx_ = 0, fy_ = 0, cx_ = 0, cy_ = 0;  // of the pinhole
  bool port_ = false;
  float origin_z_ = 0;
  Node node_;
};

}  // namespace lf::optics
