// What is true of a stripe in one picture, in few bytes: a peak that becomes a point is known some frames later.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "host_sim/optics/optics.hpp"

namespace lf::app {

// A place of the stripe in a column.
struct TruePiece {
  float v = 0, grey = 0;  // its centre; its noise-free height over the background
  float sigma_px = 0;     // standard deviation along the column; 0: not known
  float background = 0;   // grey level beside it, as the picture has it
  bool on_smooth =
      false;  // the stripe lies on one smooth surface here: no silhouette, crease or shadow's end, where the light is not even about its true centre
  bool part = false;  // light of the stripe without a centre to hold a peak against: its flank at a border, scattered light in a shadow
  bool near_mark = false;   // paint of another reflectance lies within the stripe's reach
  bool on_another = false;  // on something that is not looked for, the arm's own hand
};

struct StripeTruth {
  std::vector<std::vector<TruePiece>> columns;
};

// `looked_for`: of an object as Frame::object has it; without one, or without objects in the truth, all are.
StripeTruth stripe_truth(const optics::Frame& frame, const std::function<bool(std::uint16_t)>& looked_for = {});

// Variance of the best unbiased estimate of a piece's centre in an on-picture less its off-picture, px^2 (image-plane figures of Dorsch, Haeusler & Herrmann 1994 and of
// a least-squares fit, added):
//   speckle       C^2 sigma / (4 sqrt pi)                           C the contrast of one pixel
//   background    2 (read^2 + B / e) 2 sigma / (sqrt pi h^2)        both pictures', e electrons per grey level
//   stripe's own  sigma / (sqrt(2 pi) h e)                          shot noise of its light
struct PictureNoise {
  double read_grey = 0, electrons_per_grey = 0, speckle = 0;
  double centre_variance_px2(const TruePiece& piece) const;
  // Of one pixel of the difference, beside the stripe.
  double difference_variance(double background_grey) const;
};

}  // namespace lf::app
