// From the light that comes from the scene to a picture, in nature's order: what the water scatters forward and the lens strays is laid where it lands, ghosts, the
// lens's spot over the whole picture, speckle of the laser's light, the sensor.
//
// The order matters: a camera blurs the product of paint and light. Two planes are kept apart up to the lens, the laser's direct light and everything else, since
// speckle is the laser's alone; its grain is that of the aperture, not of the spot, so it comes after the spot.
#pragma once

#include <cstdint>
#include <vector>

#include "host_sim/optics/formation/halo_pyramid.hpp"
#include "host_sim/optics/formation/lens_spot.hpp"
#include "host_sim/optics/formation/speckle.hpp"
#include "host_sim/optics/pixel_store.hpp"
#include "host_sim/optics/sensor.hpp"

namespace lf::optics {

class Formation {
 public:
  // `scatter`: where water lays what it scatters on its way to the camera.
  explicit Formation(const Camera& camera, const ForwardScatter& scatter = {});

  // Lays the scattered and the stray light of `pixels` onto their grey; `scatters`: the water does. `line_packets` (one a packet of eight pixels, row by row) says
  // where the laser's direct light is not zero, packets beside it included or not.
  void spread(PixelStore& pixels, const std::vector<std::uint8_t>& line_packets, bool scatters, WorkerPool& pool);

  // Row v of the picture as the sensor has it, channels interleaved. After spread(), rows in any order, from several threads.
  void expose_row(const PixelStore& pixels, int v, const Speckle& speckle, const Exposing& exposing, std::uint8_t* out) const;

  // The lens's spot, wider toward the corners.
  const LensSpot& lens() const { return lens_; }

 private:
  void find_lines(const std::vector<std::uint8_t>& line_packets);
  void add_ghost(PixelStore& pixels) const;

  const Camera& camera_;
  ForwardScatter scatter_;
  HaloPyramid pyramid_;
  LensSpot lens_;
  int reach_rows_;  // of the spot, and one for samples at edges
  std::size_t packets_a_row_;
  std::vector<std::uint8_t> near_line_;       // a packet: whether the laser's light is seen there, once it has gone through the lens
  std::vector<LensSpot::Packets> line_span_;  // a row: from the first of them to the last
  std::vector<std::uint8_t> has_line_;        // a row: the laser's light falls on it, before the lens, or beside it
};

}  // namespace lf::optics
