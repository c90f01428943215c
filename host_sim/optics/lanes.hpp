// Eight lanes of float side by side: the width of a ray packet and of an AVX2 register. Private to the renderer.
//
// GCC's vector extensions: plain operators, element by element; a comparison gives an all-ones lane where it holds.
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <cmath>
#include <cstdint>
#include <cstring>

#include "shared/geometry/pose.hpp"

namespace lf::optics {

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

// The standard normal distribution's cumulative function, absolute error 1e-7 (Abramowitz and Stegun 7.1.26).
inline Lanes normal_cdf(Lanes x) {
  const Lanes z = abs(x) * 0.70710678f;
  const Lanes t = 1.f / (1.f + 0.3275911f * z);
  const Lanes tail =
      0.5f * exp(-z * z) * t * (0.254829592f + t * (-0.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f))));
  return x < 0 ? tail : 1.f - tail;
}

// Eight vectors. A scalar Vec3 joins in as all lanes alike.
struct Lanes3 {
  Lanes x{}, y{}, z{};

  Lanes3() = default;
  Lanes3(Lanes x_lanes, Lanes y_lanes, Lanes z_lanes) : x(x_lanes), y(y_lanes), z(z_lanes) {}
  explicit Lanes3(const Vec3& v)
      : x(all_lanes(static_cast<float>(v.x()))), y(all_lanes(static_cast<float>(v.y()))), z(all_lanes(static_cast<float>(v.z()))) {}
};

inline Lanes select(LaneMask mask, Lanes a, Lanes b) { return mask ? a : b; }
inline Lanes3 select(LaneMask mask, const Lanes3& a, const Lanes3& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

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

inline Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Lanes3 operator*(const Lanes3& a, Lanes s) { return {a.x * s, a.y * s, a.z * s}; }
inline Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Lanes norm(const Lanes3& a) { return sqrt(dot(a, a)); }

// Matrix times vectors; the matrix is stored as its columns.
struct Rotation {
  Lanes3 column_x, column_y, column_z;

  Rotation() = default;
  explicit Rotation(const Mat3& m) : column_x(m.col(0)), column_y(m.col(1)), column_z(m.col(2)) {}
  Lanes3 operator*(const Lanes3& v) const { return column_x * v.x + column_y * v.y + column_z * v.z; }
  Lanes3 transposed_times(const Lanes3& v) const { return {dot(column_x, v), dot(column_y, v), dot(column_z, v)}; }
};

}  // namespace lf::optics
