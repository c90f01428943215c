// Eight lanes of float side by side: eight rays, or eight columns of a picture. The width of an AVX2 register; other processors take them in pieces.
//
// GCC's vector extensions: plain operators, element by element; a comparison gives an all-ones lane where it holds.
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <cmath>
#include <cstdint>
#include <cstring>

namespace lf {

inline constexpr int lane_count = 8;

typedef float Lanes __attribute__((vector_size(32)));
typedef std::int32_t LaneMask __attribute__((vector_size(32)));  // also eight plain integers

inline Lanes all_lanes(float value) { return Lanes{} + value; }

inline Lanes load_lanes(const float* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

inline void store_lanes(float* to, Lanes lanes) { std::memcpy(to, &lanes, sizeof lanes); }

inline LaneMask load_mask(const std::int32_t* from) {
  LaneMask lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

inline void store_mask(std::int32_t* to, LaneMask lanes) { std::memcpy(to, &lanes, sizeof lanes); }

// GCC 12 makes eight instructions of any() and a comparison with a slow blend of min() and max(), where the processor has one for each.
#ifdef __AVX2__
inline bool any(LaneMask mask) { return _mm256_testz_si256(reinterpret_cast<__m256i>(mask), reinterpret_cast<__m256i>(mask)) == 0; }
inline Lanes min(Lanes a, Lanes b) { return _mm256_min_ps(a, b); }
inline Lanes max(Lanes a, Lanes b) { return _mm256_max_ps(a, b); }
#else
inline bool any(LaneMask mask) {
  std::int32_t bits = 0;
  for (int i = 0; i < lane_count; ++i) bits |= mask[i];
  return bits != 0;
}
inline Lanes min(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes max(Lanes a, Lanes b) { return a > b ? a : b; }
#endif

inline Lanes clamp(Lanes x, float low, float high) { return min(max(x, all_lanes(low)), all_lanes(high)); }

inline Lanes abs(Lanes x) {
  LaneMask bits;
  std::memcpy(&bits, &x, sizeof bits);
  bits &= 0x7FFFFFFF;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

inline Lanes sqrt(Lanes x) {
  Lanes root;
  for (int i = 0; i < lane_count; ++i) root[i] = std::sqrt(x[i]);
  return root;
}

inline Lanes floor(Lanes x) {
  Lanes whole;
  for (int i = 0; i < lane_count; ++i) whole[i] = std::floor(x[i]);
  return whole;
}

// Relative error below 3e-7 over [-87, 87], outside it is held there: Cephes' expf, split at multiples of ln 2.
inline Lanes exp(Lanes x) {
  x = clamp(x, -87.f, 87.f);
  const Lanes half = x < 0 ? all_lanes(-0.5f) : all_lanes(0.5f);
  const LaneMask power = __builtin_convertvector(x * 1.44269504f + half, LaneMask);
  const Lanes n = __builtin_convertvector(power, Lanes);
  const Lanes r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
  const Lanes series =
      (((((1.9875691500e-4f * r + 1.3981999507e-3f) * r + 8.3334519073e-3f) * r + 4.1665795894e-2f) * r + 1.6666665459e-1f) * r +
       5.0000001201e-1f) *
          r * r +
      r + 1.f;
  const LaneMask scale_bits = (power + 127) << 23;
  Lanes scale;
  std::memcpy(&scale, &scale_bits, sizeof scale);
  return series * scale;
}

// Natural logarithm of normal numbers above 0, relative error below 3e-7: Cephes' logf.
inline Lanes log(Lanes x) {
  LaneMask bits;
  std::memcpy(&bits, &x, sizeof bits);
  LaneMask power = (bits >> 23) - 126;  // x is a mantissa of 0.5 to 1 times 2^power
  bits = (bits & 0x007FFFFF) | 0x3F000000;
  Lanes mantissa;
  std::memcpy(&mantissa, &bits, sizeof mantissa);
  const LaneMask low = mantissa < 0.707106781f;
  power += low;  // an all-ones lane is -1
  const Lanes m = (low ? mantissa + mantissa : mantissa) - 1.f;
  const Lanes n = __builtin_convertvector(power, Lanes);
  const Lanes z = m * m;
  const Lanes series =
      ((((((((7.0376836292e-2f * m - 1.1514610310e-1f) * m + 1.1676998740e-1f) * m - 1.2420140846e-1f) * m + 1.4249322787e-1f) * m -
          1.6668057665e-1f) *
             m +
         2.0000714765e-1f) *
            m -
        2.4999993993e-1f) *
           m +
       3.3333331174e-1f);
  return (m + (m * z * series - n * 2.12194440e-4f - 0.5f * z)) + n * 0.693359375f;
}

// The standard normal distribution's cumulative function, absolute error 1e-7 (Abramowitz and Stegun 7.1.26).
inline Lanes normal_cdf(Lanes x) {
  const Lanes z = abs(x) * 0.70710678f;
  const Lanes t = 1.f / (1.f + 0.3275911f * z);
  const Lanes tail =
      0.5f * exp(-z * z) * t * (0.254829592f + t * (-0.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f))));
  return x < 0 ? tail : 1.f - tail;
}

inline Lanes select(LaneMask mask, Lanes a, Lanes b) { return mask ? a : b; }

// Calls visit(value, lanes) once for each different value among the lanes.
template <class Visit>
void visit_values(LaneMask values, Visit visit) {
  LaneMask left = LaneMask{} - 1;
  for (int i = 0; i < lane_count; ++i) {
    if (left[i] == 0) continue;
    const LaneMask alike = values == values[i];
    visit(values[i], alike);
    left &= ~alike;
  }
}

}  // namespace lf
