#include "host_sim/optics/formation/normal_deviates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "shared/lanes/lanes.hpp"
#include "shared/random.hpp"

namespace lf::optics {
namespace {

constexpr std::size_t quantile_bits = 12;
constexpr std::size_t quantile_count = std::size_t{1} << quantile_bits;

// Acklam's rational approximation of the inverse normal distribution (relative error 1e-9), at the middles of 4096 equal shares.
double inverse_normal_cdf(double p) {
  constexpr double a[] = {-3.969683028665376e+01, 2.209460984245205e+02,  -2.759285104469687e+02,
                          1.383577518672690e+02,  -3.066479806614716e+01, 2.506628277459239e+00};
  constexpr double b[] = {-5.447609879822406e+01, 1.615858368580409e+02, -1.556989798598866e+02, 6.680131188771972e+01,
                          -1.328068155288572e+01};
  constexpr double c[] = {-7.784894002430293e-03, -3.223964580411365e-01, -2.400758277161838e+00,
                          -2.549732539343734e+00, 4.374664141464968e+00,  2.938163982698783e+00};
  constexpr double d[] = {7.784695709041462e-03, 3.224671290700398e-01, 2.445134137142996e+00, 3.754408661907416e+00};
  if (p > 0.5) return -inverse_normal_cdf(1 - p);
  if (p < 0.02425) {
    const double q = std::sqrt(-2 * std::log(p));
    return (((((c[0] * q + c[1]) * q + c[2]) * q + c[3]) * q + c[4]) * q + c[5]) / ((((d[0] * q + d[1]) * q + d[2]) * q + d[3]) * q + 1);
  }
  const double q = p - 0.5, r = q * q;
  return (((((a[0] * r + a[1]) * r + a[2]) * r + a[3]) * r + a[4]) * r + a[5]) * q /
         (((((b[0] * r + b[1]) * r + b[2]) * r + b[3]) * r + b[4]) * r + 1);
}

// Scaled to unit variance: the middles of the outermost shares miss the far tails.
std::array<float, quantile_count> make_quantiles() {
  std::array<float, quantile_count> table{};
  double squares = 0;
  for (std::size_t i = 0; i < quantile_count; ++i) {
    const double q = inverse_normal_cdf((static_cast<double>(i) + 0.5) / quantile_count);
    squares += q * q;
    table[i] = static_cast<float>(q);
  }
  const double scale = std::sqrt(quantile_count / squares);
  for (float& q : table) q = static_cast<float>(q * scale);
  return table;
}

const std::array<float, quantile_count>& quantiles() {
  static const std::array<float, quantile_count> table = make_quantiles();
  return table;
}

typedef std::uint32_t WordLanes __attribute__((vector_size(32)));

// Wellons' lowbias32: every input bit flips each output bit with probability 0.5 +/- 0.17 %.
template <typename Word>
Word mix(Word x) {
  x = (x ^ (x >> 16)) * 0x7feb352dU;
  x = (x ^ (x >> 15)) * 0x846ca68bU;
  return x ^ (x >> 16);
}

// Which of the quantiles a number has.
template <typename Word>
Word place_of(Word number, std::uint64_t key) {
  const auto low = static_cast<std::uint32_t>(key), high = static_cast<std::uint32_t>(key >> 32);
  return mix(mix(number ^ low) + high) >> (32 - quantile_bits);
}

}  // namespace

float normal_deviate(std::uint32_t number, std::uint64_t key) { return quantiles()[place_of(number, key)]; }

// The places go through memory: taking them out of a vector one by one costs more than all else here.
void normal_deviates(std::uint32_t first, std::size_t count, std::uint64_t key, float* out) {
  constexpr std::size_t block = 64;
  constexpr WordLanes count_up{0, 1, 2, 3, 4, 5, 6, 7};
  const float* table = quantiles().data();
  std::array<std::uint32_t, block> place;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t size = (std::min(count - begin, block) + lane_count - 1) / lane_count * lane_count;
    for (std::size_t i = 0; i < size; i += lane_count) {
      const WordLanes of_eight = place_of(count_up + (first + static_cast<std::uint32_t>(begin + i)), key);
      std::memcpy(place.data() + i, &of_eight, sizeof of_eight);
    }
    for (std::size_t i = 0; i < size; ++i) out[begin + i] = table[place[i]];
  }
}

std::uint64_t noise_key(std::uint64_t seed, std::uint64_t camera, std::uint64_t frame_number) {
  return splitmix64(splitmix64(splitmix64(seed) + camera) + frame_number);
}

}  // namespace lf::optics
