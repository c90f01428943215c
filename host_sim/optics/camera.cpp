#include "host_sim/optics/camera.hpp"

namespace lf::optics {

Camera::Camera(const CameraConfig& camera)
    : config(camera), place(camera.base_from_camera), rays(camera.intrinsics, camera.port), sensor(camera) {}

RayPacket Camera::sub_pixels(int u, int v, int half) const {
  // Of each row, column and diagonal two of the four.
  constexpr Lanes first_u{-0.375f, 0.125f, -0.125f, 0.375f, -0.125f, 0.375f, -0.375f, 0.125f};
  constexpr Lanes second_u{-0.125f, 0.375f, -0.375f, 0.125f, -0.375f, 0.125f, -0.125f, 0.375f};
  constexpr Lanes offset_v{-0.375f, -0.375f, -0.125f, -0.125f, 0.125f, 0.125f, 0.375f, 0.375f};
  return rays.around(place, u, v, half == 0 ? first_u : second_u, offset_v);
}

GreyLanes Camera::grey(const RgbLanes& radiance) const {
  const float scale = sensor.grey_per_radiance();
  if (config.colour) return {radiance[0] * scale, radiance[1] * scale, radiance[2] * scale};
  const Rgb& response = config.response;
  return {scale * (response[0] * radiance[0] + response[1] * radiance[1] + response[2] * radiance[2]), Lanes{}, Lanes{}};
}

}  // namespace lf::optics
