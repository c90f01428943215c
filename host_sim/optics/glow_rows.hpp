// The sheets' glow over a row of tiles.
//
// Down the picture it changes slowly. It is worked out in full along the row's upper border and the next row's. Between the two it is interpolated where both are
// of one zone of the sheet and differ by a tenth at most, so that the error is about 0.2 %; elsewhere it is worked out in full.
#pragma once

#include <vector>

#include "host_sim/optics/camera.hpp"
#include "host_sim/optics/shader.hpp"

namespace lf::optics {

class GlowRows {
 public:
  // Of the pixel rows from `first` to before `end`, which is at most the picture's height. `camera` and `shader` outlive it.
  GlowRows(const Camera& camera, const Shader& shader, int first, int end);

  // Of pixels (u .. u + 7, v); u a multiple of eight.
  Glow at(std::size_t sheet, int u, int v) const;

 private:
  struct Column {
    Glow upper, lower;
    bool even = false;  // between the two
  };

  const Camera& camera_;
  const Shader& shader_;
  int first_, end_;
  std::size_t packets_a_row_;
  std::vector<Column> columns_;  // a sheet after the other, of each a packet after the other
};

}  // namespace lf::optics
