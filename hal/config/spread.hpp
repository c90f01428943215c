// A random quantity as a scenario states it: a number, or a range to draw from.
#pragma once

#include <cstdint>

namespace lf::config {

// Uniform between `min` and `max`; a fixed number when they are equal.
struct Spread {
  double min = 0;
  double max = 0;

  static constexpr Spread fixed(double value) { return {value, value}; }
  static constexpr Spread around(double centre, double half_width) { return {centre - half_width, centre + half_width}; }
  bool operator==(const Spread&) const = default;
};

// Something that is there or not; `either` is drawn with even odds.
enum class Chance : std::uint8_t { no, yes, either };

}  // namespace lf::config
