// What an image's pixel centres meet and how bright they are, and which of them lie at an edge.
#pragma once

#include <vector>

#include "host_sim/optics/camera.hpp"
#include "host_sim/optics/light.hpp"
#include "host_sim/optics/ray_scene.hpp"

namespace lf::optics {

// What eight rays meet and bring back.
struct Sample {
  HitPacket hit;
  LaneMask reached{}, lit{};               // as Light's
  GreyLanes grey{}, scattered{}, laser{};  // Light's radiance, scattered and laser

  void set(const Light& light, const Camera& camera);  // all but `hit`
  // Whether all lanes see one surface without a crease or a step, in the same light and in no stripe's.
  bool is_even() const;
};

// Planes of values of a picture, one a channel.
using GreyPlanes = std::vector<float>;

// Samples of every pixel, padded to whole packets. Planes of grey values, one a channel, follow each other.
struct PixelStore {
  void resize(int width, int height, std::size_t channels);
  // A packet's worth of room before the first and after the last pixel, so that neighbours can be read without asking.
  std::size_t index(int u, int v) const { return static_cast<std::size_t>(v) * stride + static_cast<std::size_t>(u) + lane_count; }

  Sample sample(std::size_t i) const;
  void set(std::size_t i, const Sample& sample);
  GreyLanes at(const GreyPlanes& planes, std::size_t i) const;
  void set_light(std::size_t i, const Sample& sample);
  // The light of a packet, all of a packet but its light: from a store of the same size.
  void copy_light(std::size_t i, const PixelStore& from);
  void copy_surface(std::size_t i, const PixelStore& from);

  // Which of the pixels (u .. u + 7, v) differ from a neighbour in shape, depth, slope, or in what of the light that reaches both falls on them.
  LaneMask edges(int u, int v) const;
  // Whether two pixels of a column see one plane, of one shape or of two: their normals are alike, and the inverse depth,
  // which is linear over a plane, goes on from one to the other.
  bool on_one_plane(std::size_t a, std::size_t b) const;

  int width = 0, height = 0;
  std::size_t stride = 0, plane = 0, channels = 0;
  std::vector<float> depth_m, normal_x, normal_y, normal_z;  // depth past the ray's origin
  GreyPlanes grey, scattered, laser;                         // Sample's
  std::vector<std::int32_t> shape, reached, lit;             // Sample::reached and lit

 private:
  void set_surface(std::size_t i, const HitPacket& hit, LaneMask reached_lanes, LaneMask lit_lanes);
  void set_planes(GreyPlanes& planes, std::size_t i, const GreyLanes& values) const;
  LaneMask edge_between(std::size_t a, std::size_t b) const;
};

}  // namespace lf::optics
