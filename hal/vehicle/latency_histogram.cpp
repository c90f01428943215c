#include "hal/vehicle/latency_histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lf::hal {

namespace {

// Bucket 0 is everything up to 1 us; each octave above is cut into equal parts, so that finding one takes no logarithm.
std::size_t bucket_of(std::int64_t ns) {
  const auto us16 =
      static_cast<std::uint64_t>(std::max<std::int64_t>(ns, 0)) * LatencyHistogram::per_octave / 1000;  // sixteenths of a microsecond
  if (us16 < LatencyHistogram::per_octave) return 0;
  const auto octave = static_cast<std::size_t>(std::bit_width(us16)) - 5;  // 16 has 5 bits
  const std::size_t part = (us16 >> octave) - LatencyHistogram::per_octave;
  return std::min(octave * LatencyHistogram::per_octave + part, LatencyHistogram::bucket_count - 1);
}

}  // namespace

void LatencyHistogram::add(Duration d) {
  std::atomic<std::uint64_t>& bucket = buckets_[bucket_of(d.ns())];
  bucket.store(bucket.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  count_.store(count_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  if (d.ns() > max_ns_.load(std::memory_order_relaxed)) max_ns_.store(d.ns(), std::memory_order_relaxed);
}

double LatencyHistogram::upper_edge_us(std::size_t bucket) {
  const std::size_t octave = bucket / per_octave, part = bucket % per_octave;
  return std::ldexp(1.0 + static_cast<double>(part + 1) / per_octave, static_cast<int>(octave));
}

double LatencyHistogram::percentile_us(double p) const {
  const std::uint64_t total = count();
  if (total == 0) return 0;
  const auto wanted = static_cast<std::uint64_t>(std::ceil(p * static_cast<double>(total)));
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < bucket_count; ++i) {
    seen += bucket(i);
    if (seen >= wanted && seen > 0) return i + 1 == bucket_count ? max_us() : std::min(upper_edge_us(i), max_us());
  }
  return max_us();
}

}  // namespace lf::hal
