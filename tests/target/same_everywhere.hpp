// Inputs that are the same on every processor, and the place for the big ones.
#pragma once

#include <algorithm>
#include <cstdint>

#include "shared/geometry/pose.hpp"
#include "shared/random.hpp"

// On a board, big objects go to its external memory (toolchain/cortex_m7/mps2_an500.ld).
#ifdef __arm__
#define LANTERNFISH_EXTERNAL_MEMORY [[gnu::section(".bss.psram")]]
#else
#define LANTERNFISH_EXTERNAL_MEMORY
#endif

namespace lf::test {

// Steele, Lea, Flood, OOPSLA 2014.
class SameRandom {
 public:
  explicit SameRandom(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    const std::uint64_t drawn = splitmix64(state_);
    state_ += splitmix64_step;
    return drawn;
  }
  // 0 to n - 1.
  std::int32_t below(std::int32_t n) { return static_cast<std::int32_t>(bits() % static_cast<std::uint32_t>(n)); }
  // In [-1, 1), a multiple of 2^-20.
  double share() { return static_cast<double>(static_cast<std::int64_t>(bits() >> 43) - (std::int64_t{1} << 20)) / (1 << 20); }
  // Each in [-1, 1). Arguments of one call are drawn in no certain order: of several shares at once, ask here.
  Vec3 shares() {
    Vec3 v;
    for (double& c : v) c = share();
    return v;
  }

 private:
  std::uint64_t state_;
};

// Grey levels of a stripe `distance` 256ths of a pixel from its centre: a bump of quadratic flanks, 4 px to either side.
inline std::int32_t stripe_grey(std::int32_t distance_256, std::int32_t amplitude) {
  constexpr std::int32_t half_width = 4 * 256;
  const std::int32_t left = std::max<std::int32_t>(0, half_width - std::abs(distance_256));
  return static_cast<std::int32_t>(std::int64_t{amplitude} * left * left / (half_width * half_width));
}

}  // namespace lf::test
