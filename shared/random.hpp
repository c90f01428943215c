// Random numbers that are the same everywhere: splitmix64 (Steele, Lea, Flood, OOPSLA 2014).
#pragma once

#include <cstdint>

namespace lf {

// What the generator's state grows by at each draw.
inline constexpr std::uint64_t splitmix64_step = 0x9E3779B97F4A7C15u;

// The draw that follows state `x`: a hash of it, one to one.
constexpr std::uint64_t splitmix64(std::uint64_t x) {
  x += splitmix64_step;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

}  // namespace lf
