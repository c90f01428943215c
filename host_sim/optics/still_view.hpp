// What a camera sees of the resting bodies in base light: kept from frame to frame, made anew where what it was made from has changed.
//
// It is made from the resting bodies' poses, from the lamps that are on and from where they are; nothing else goes into it. When a fixed body or a lamp has
// moved or was switched, all of it is made anew; when a yielding body has moved, the tiles in which that body was or is seen, or was or is in a lamp's way.
// Made anew or kept, it has the same bits.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host_sim/optics/body_bounds.hpp"
#include "host_sim/optics/pixel_store.hpp"
#include "host_sim/optics/shader.hpp"
#include "host_sim/optics/tiles.hpp"
#include "host_sim/optics/worker_pool.hpp"

namespace lf::optics {

// A pixel's 4x4 sub-pixels, as Camera::sub_pixels has them, and their mean.
struct SubPixels {
  void average(std::size_t channels);
  std::array<Sample, 2> half;
  std::array<float, 3> grey{}, scattered{}, laser{};
};

class StillView {
 public:
  // `camera` and `tiles` outlive it.
  StillView(const Camera& camera, const Tiles& tiles, const scene::Scene& scene, bool edge_sampling);

  // Brings the view to these poses and to the lamps that are on, of which `lamp_bodies` has the bodies, for `lamp_share` of the exposure; `shader` has the same poses
  // and lamps. Returns whether anything had to be made anew.
  bool update(const Shader& shader, const scene::BodyPoses& poses, const std::vector<scene::BodyId>& lamp_bodies, float lamp_share,
              WorkerPool& pool);

  const PixelStore& pixels() const { return pixels_; }

  // Whether pixels (u .. u + 7, v) meet nothing.
  bool open_water(int u, int v) const { return packets_[packet(u, v)].open_water; }

  // What the surfaces of pixels (u .. u + 7, v) reflect.
  RgbLanes albedo(int u, int v) const;

  // Which of the pixels (u .. u + 7, v) lie at an edge; none without edge sampling.
  LaneMask edges(int u, int v) const;

  // The sub-pixels of a pixel at an edge; nullptr elsewhere.
  const SubPixels* sub_pixels(int u, int v) const;

  // The lamps' haze along row v; empty with the lamps off.
  std::vector<float> haze_row(int v) const;

  // Whether the bodies may stand between a lamp and what its light reaches in the tile.
  bool may_be_shaded(std::size_t tile, const BodyBounds& bodies) const;

 private:
  struct Packet {
    bool open_water = true;
    std::uint8_t edges = 0;        // a bit a lane
    std::uint32_t first_kept = 0;  // in its tile's vector
  };
  struct Yielding {
    std::size_t body;
    BodyBounds bounds;
    Pose pose;
  };
  std::size_t packet(int u, int v) const { return static_cast<std::size_t>(v) * packets_a_row_ + static_cast<std::size_t>(u / lane_count); }
  bool find_stale(const scene::BodyPoses& poses, const std::vector<scene::BodyId>& lamp_bodies, float lamp_share);
  void mark(const BodyBounds& bodies);
  bool stale_about(int column, int tile_row) const;
  void sample_tiles(const Shader& shader, int tile_row);
  void sample_packet(const Shader& shader, int u, int v, const std::vector<float>* haze_row);
  void keep_edges(const Shader& shader, int column, int tile_row);
  void bound_reached_points(const Shader& shader, int column, int tile_row);
  SubPixels trace_sub_pixels(const Shader& shader, int u, int v, const std::vector<float>* haze_row) const;

  const Camera& camera_;
  const Tiles& tiles_;
  bool edge_sampling_;
  std::size_t packets_a_row_;

  std::vector<scene::BodyId> lamp_bodies_;
  float lamp_share_ = 0;
  std::vector<std::size_t> fixed_;  // bodies
  std::vector<Pose> fixed_poses_;   // of the fixed bodies and the lamps'; empty before the first update
  std::vector<Yielding> yielding_;
  std::vector<std::uint8_t> stale_;  // a tile

  std::optional<LampHaze> haze_;
  PixelStore pixels_;
  std::array<std::vector<float>, 3> albedo_;  // planes as those of pixels_
  std::vector<Packet> packets_;
  std::vector<std::vector<SubPixels>> kept_;   // a vector a tile
  std::vector<std::vector<Cone>> lamp_cones_;  // a vector a tile: from each lamp to what its light reaches there
};

}  // namespace lf::optics
