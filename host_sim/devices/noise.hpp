// Seeded noise for sensors: the same numbers for the same seed, on every machine.
#pragma once

#include <cstdint>

#include "shared/random.hpp"

namespace lf::devices {

class Noise {
 public:
  explicit Noise(std::uint64_t seed) : state_(seed) {}

  // Zero mean, unit variance, within +/-3.5: the sum of four uniforms (Irwin-Hall) is near enough to a Gaussian for a sensor.
  double next() {
    const std::uint64_t bits = next_bits();
    std::int64_t sum = 0;
    for (int i = 0; i < 4; ++i) sum += static_cast<std::int64_t>((bits >> (16 * i)) & 0xFFFF);
    return (static_cast<double>(sum) / 65536.0 - 2.0 + 2.0 / 65536.0) * 1.7320508075688772;  // variance of the sum is 4 / 12
  }

 private:
  std::uint64_t next_bits() {
    const std::uint64_t bits = splitmix64(state_);
    state_ += splitmix64_step;
    return bits;
  }

  std::uint64_t state_;
};

}  // namespace lf::devices
