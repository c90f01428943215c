// Seeded noise for sensors: the same numbers for the same seed, on every machine.
#pragma once

#include <cstdint>

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
  // splitmix64 (Steele, Lea, Flood 2014).
  std::uint64_t next_bits() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

}  // namespace lf::devices
