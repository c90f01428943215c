// The passes that make one frame: a sample a pixel, sixteen where there is an edge, the sensor, and the ground truth. Each works on blocks of rows.
#pragma once

#include <algorithm>
#include <vector>

#include "host_sim/optics/sensor.hpp"
#include "host_sim/optics/shader.hpp"

namespace lf::optics {

// What the first pass keeps of each pixel, padded to whole packets. Planes of grey values, one a channel, follow each other.
struct PixelStore {
  void resize(int width, int height, int channels);
  // A packet's worth of room before the first and after the last pixel, so that neighbours can be read without asking.
  std::size_t index(int u, int v) const { return static_cast<std::size_t>(v) * stride + static_cast<std::size_t>(u) + lane_count; }

  std::size_t stride = 0, plane = 0;
  std::vector<float> depth_m, normal_x, normal_y, normal_z, grey;
  std::vector<std::int32_t> shape, reached, lit;
};

class RenderPass {
 public:
  static constexpr int block_rows = 8;

  RenderPass(const CameraConfig& camera, const CameraRays& rays, const Sensor& sensor, const Shader& shader, const LampHaze* haze,
             PixelStore& store);

  int blocks() const { return (camera_.intrinsics.height + block_rows - 1) / block_rows; }

  void sample_block(int block) const;                              // first
  void resample_edges(int block, std::vector<float>& grey) const;  // reads the store, writes whole rows of `grey`
  void expose_block(int block, const std::vector<float>& grey, std::uint64_t key, Frame& frame) const;

  // Depth and object of each pixel centre.
  void write_geometry(int block, const std::vector<std::uint16_t>& object_of_shape, Frame& frame) const;

  // The true centres of `laser`'s stripe among this block's rows.
  struct StripeCentre {
    std::int32_t u;
    float v, grey;
  };
  std::vector<StripeCentre> stripe_centres(int block, std::size_t laser) const;

 private:
  std::array<Lanes, 3> channels(const RgbLanes& radiance) const;
  LaneMask edge_between(std::size_t a, std::size_t b) const;
  LaneMask edges(int u, int v) const;
  void resample(int u, int v, const std::vector<float>* haze_row, std::vector<float>& grey) const;
  SurfacePacket stored_surface(const RayPacket& rays, int u, int v, HitPacket& hit) const;
  void refine_stripe(std::size_t laser, int u, int v, Lanes offset_v, LaneMask wanted, std::vector<StripeCentre>& centres) const;
  int first_row(int block) const { return block * block_rows; }
  int end_row(int block) const { return std::min(camera_.intrinsics.height, (block + 1) * block_rows); }

  const CameraConfig& camera_;
  CameraPlace place_;
  const CameraRays& rays_;
  const Sensor& sensor_;
  const Shader& shader_;
  const LampHaze* haze_;
  PixelStore& store_;
  int channel_count_;
};

}  // namespace lf::optics
