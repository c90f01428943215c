// Wide blurs of a whole picture, cheap: each Gaussian is applied to a picture halved until it is a few pixels wide there, and the sums are brought back up.
//
// Halving and doubling blur, too, by (1 3 3 1) / 8 each. A reduction by n and back has a variance of (n^2 - 1) / 2, so the Gaussian in between has that much less.
// Beyond its borders a picture goes on as it ends: an even one stays even. The sums are taken in one order for any number of threads.
#pragma once

#include <cstdint>
#include <vector>

#include "host_sim/optics/formation/gaussian_taps.hpp"
#include "host_sim/optics/worker_pool.hpp"

namespace lf::optics {

// Rows of floats in somebody's memory; each row may be read up to a multiple of eight.
template <class Value>
struct PlaneView {
  Value* first = nullptr;
  std::size_t stride = 0;
  int width = 0, height = 0;
  Value* row(int v) const { return first + static_cast<std::size_t>(v) * stride; }
};

struct HaloTerm {
  float weight = 0;
  double sigma_px = 0;
};

// A plane that is 0 on the rows without a flag.
struct SparsePlane {
  PlaneView<const float> plane;
  const std::vector<std::uint8_t>& rows;
};

class HaloPyramid {
 public:
  HaloPyramid(int width, int height);

  // Adds to `onto` the sum over `scattered_terms` of weight * Gaussian(sigma) * scattered, and the one `stray_term` of the sum of `grey` and `line`, all of the same
  // size. `onto` may be `grey`.
  void add(PlaneView<const float> scattered, const std::vector<HaloTerm>& scattered_terms, PlaneView<const float> grey,
           const SparsePlane& line, HaloTerm stray_term, PlaneView<float> onto, WorkerPool& pool);

 private:
  struct Level {
    int width = 0, height = 0;
    std::size_t stride = 0;
    std::vector<float> scattered, stray, halo;
  };
  struct Placed {
    GaussianTaps taps;
    float weight = 0;
    bool stray = false;
  };
  void place(HaloTerm term, bool stray);
  void halve_sources(PlaneView<const float> scattered, PlaneView<const float> grey, const SparsePlane& line, WorkerPool& pool);
  void gather(std::size_t level);

  std::vector<Level> levels_;               // levels_[0] is half the picture
  std::vector<std::vector<Placed>> terms_;  // of each level
  std::vector<float> row_;
};

}  // namespace lf::optics
