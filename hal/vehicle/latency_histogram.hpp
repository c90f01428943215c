// How long something took, kept for ever in fixed memory: logarithmic buckets of 1/16 octave (6 %), from 1 us to 1 s.
//
// One thread adds, any thread reads: counts are atomic, so a reader may see one sample more in one bucket than in the total, never a torn number.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "shared/messages/time.hpp"

namespace lf::hal {

class LatencyHistogram {
 public:
  static constexpr std::size_t per_octave = 16;
  static constexpr std::size_t octaves = 20;                             // 2^20 us are 1.05 s
  static constexpr std::size_t bucket_count = per_octave * octaves + 1;  // the last one takes all that is longer

  void add(Duration d);

  std::uint64_t count() const { return count_.load(std::memory_order_relaxed); }
  double max_us() const { return static_cast<double>(max_ns_.load(std::memory_order_relaxed)) * 1e-3; }
  // Upper edge of the bucket in which the share `p` (0..1) of all samples is reached, at most max_us(); 0 without samples.
  double percentile_us(double p) const;

  static double upper_edge_us(std::size_t bucket);
  std::uint64_t bucket(std::size_t i) const { return buckets_[i].load(std::memory_order_relaxed); }

 private:
  std::array<std::atomic<std::uint64_t>, bucket_count> buckets_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::int64_t> max_ns_{0};
};

}  // namespace lf::hal
