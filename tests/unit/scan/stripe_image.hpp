// Images of a laser stripe by a model of the tests' own, with the stripe's true centre in each column.
//
// A Gaussian stripe integrated over the pixels on a textured scene, with a one-sided backscatter skirt, sensor noise and clipping; the same scene
// without the laser goes with it.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/messages/image.hpp"

namespace lf::test {

struct StripeModel {
  int width = 640, height = 480;
  double sigma_px = 1.5;
  double amplitude = 120;  // grey levels
  double noise = 1;        // grey levels rms
  double skirt = 0;        // backscatter under the stripe, as a share of the amplitude; 12 px wide and 6 px off centre
  double step = 0;         // glow that ends at the stripe, as a share of the amplitude
  double texture = 10;     // grey levels either way about 30
  std::uint64_t seed = 1;
};

struct StripeImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> on, off;
  std::vector<double> centre_px;  // of each column

  ImageView on_view() const { return {on.data(), width, height, width}; }
  ImageView off_view() const { return {off.data(), width, height, width}; }
};

StripeImage make_stripe_image(const StripeModel& model);

}  // namespace lf::test
