// An image in tiles of 32 x 8 pixels: what is asked once for all of a tile's rays.
#pragma once

#include <algorithm>
#include <vector>

#include "host_sim/optics/body_bounds.hpp"
#include "host_sim/optics/camera.hpp"

namespace lf::optics {

class Tiles {
 public:
  static constexpr int width_px = 32, height_px = 8;

  explicit Tiles(const Camera& camera);

  std::size_t count() const { return view_.size(); }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  int first_row(int tile_row) const { return tile_row * height_px; }  // of pixels
  int end_row(int tile_row) const { return std::min(image_height_, (tile_row + 1) * height_px); }
  std::size_t at(int u, int v) const {
    return static_cast<std::size_t>(v / height_px) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(u / width_px);
  }

  // Holds the rays of the tile's pixels and of those round it.
  const Cone& view(std::size_t tile) const { return view_[tile]; }

 private:
  int image_height_, columns_, rows_;
  std::vector<Cone> view_;
};

}  // namespace lf::optics
