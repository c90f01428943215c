// The passes that make the light of one frame of a still view: moving bodies and laser put in, up to sixteen samples where there is an edge or a stripe on a mark's, and
// the ground truth.
// Each works on rows of tiles.
#pragma once

#include <vector>

#include "host_sim/optics/formation/lens_spot.hpp"
#include "host_sim/optics/still_view.hpp"

namespace lf::optics {

// What of a frame is not its still view's, bit by bit: of a tile what may be, of a packet what is.
enum Change : std::uint8_t { hidden = 1, shaded = 2, striped = 4, skirted = 8 };
using Changes = std::uint8_t;

// The frame being made. Packets whose `changes` are 0 hold the still view's surfaces, left from earlier frames.
struct LiveView {
  LiveView(const Camera& camera, const Tiles& tiles);
  void forget() { packets.assign(packets.size(), hidden); }  // the still view is another
  PixelStore pixels;
  std::vector<Changes> packets, tiles;
};

class RenderPass {
 public:
  // `lens`: the spot that stripe_centres() counts to a stripe's width.
  RenderPass(const Camera& camera, const LensSpot& lens, const Tiles& tiles, const StillView& still, const Shader& shader,
             const BodyBounds& arm, LiveView& live);

  // Each tile row of a pass must be done before the next pass begins.
  void sample(int tile_row) const;          // first: a sample a pixel
  void resample_edges(int tile_row) const;  // second, where edge sampling is wanted
  void resample_marks(int tile_row) const;  // marks' edges under a stripe: the mean of paint times light is not the product of their means

  // A packet of eight pixels, row by row: whether a laser's line may light it.
  std::vector<std::uint8_t> lines() const;

  // Depth and object of each pixel centre; `object_of_shape` begins with open water's.
  void write_geometry(int tile_row, const std::vector<std::uint16_t>& object_of_shape, Frame& frame) const;

  // The true centres of `laser`'s stripe among this tile row's pixels.
  struct StripeCentre {
    std::int32_t u;
    float v, grey, sigma_px;
    bool near_mark;
    bool shaded;  // something is before it in the sheet: only light that the water has scattered comes there, so high
  };
  std::vector<StripeCentre> stripe_centres(int tile_row, std::size_t laser) const;

 private:
  Changes judge_tiles(int tile_row) const;
  void sample_packet(int u, int v, const std::vector<float>* haze_row) const;
  Changes put_in_moving(const RayPacket& rays, Changes possible, float footprint, const HazePlace& haze, Sample& sample) const;
  Changes add_stripes(const RayPacket& rays, float footprint, const RgbLanes* albedo, Sample& sample) const;
  void add_glow(const RayLines& rays, Lanes surface_parameter, GreyLanes& grey) const;
  std::vector<Glow> glows(int u, int v) const;
  Changes changes_about(int u, int v) const;
  LaneMask marks_under_stripe(int u, int v) const;
  void resample(int u, int v, Changes changes, const std::vector<Glow>& glows, const std::vector<float>* haze_row) const;
  void put(int u, int v, const SubPixels& mean) const;
  void add_even_light(int u, int v, const SubPixels& kept) const;
  SubPixels sample_sub_pixels(int u, int v, Changes changes, const std::vector<float>* haze_row) const;
  float blur_px(int u, int v) const;
  RgbLanes albedo(int u, int v) const;  // of pixels (u .. u + 7, v)
  LaneMask near_marks(int u, int v, float sigma_px) const;
  void refine_stripe(std::size_t laser, int u, int v, Lanes offset_v, LaneMask wanted, std::vector<StripeCentre>& centres) const;
  std::size_t packet(int u, int v) const {
    return static_cast<std::size_t>(v) * live_.pixels.stride / lane_count + static_cast<std::size_t>(u / lane_count);
  }

  const Camera& camera_;
  const LensSpot& lens_;
  const Tiles& tiles_;
  const StillView& still_;
  const Shader& shader_;
  const BodyBounds& arm_;
  LiveView& live_;
};

}  // namespace lf::optics
