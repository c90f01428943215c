#include "firmware/scan/plane.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "firmware/scan/plane_bend.hpp"
#include "shared/random.hpp"

namespace lf::scan {

// normal . p + offset = 0 about the cloud's centre.
struct PlaneFitter::Hypothesis {
  Vec3 normal = Vec3::UnitZ();
  double offset_m = 0;
  double score = std::numeric_limits<double>::infinity();
};

namespace {

constexpr std::size_t block = 16;  // floats that GCC keeps in two AVX registers
// The refits reach this much beyond the inliers. To cut the noise off at the threshold itself locks on to a part of the points where the noise is not
// small against it: the stripes of a real laser, 0.9 mm rms, gave a plane 0.31 degrees off at 2 mm, 0.0 at twice that.
constexpr double window_thresholds = 2.0;
constexpr int max_refits = 20;  // 3 to 6 are usual; the set of inliers may flip between two of equal merit

// Uniform in 0..n-1, n < 2^32; biased by less than n / 2^32.
std::size_t draw_below(std::uint64_t& state, std::size_t n) {
  const std::uint64_t drawn = splitmix64(state);
  state += splitmix64_step;
  return static_cast<std::size_t>(((drawn >> 32) * n) >> 32);
}

// By the exponent's bits: arithmetic on infinities would raise floating-point exceptions, which the tests trap.
bool finite(float value) { return (std::bit_cast<std::uint32_t>(value) & 0x7F800000u) != 0x7F800000u; }
bool finite(const CloudPoint& point) { return finite(point.p_m.x()) & finite(point.p_m.y()) & finite(point.p_m.z()); }

// Zeroth to second moments of the points near a plane, about `centre`.
struct Moments {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  Vec3 mean() const { return Vec3(x, y, z) / n; }
  Mat3 covariance() const {
    const Vec3 m = mean();
    Mat3 c;
    c << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return c / n - m * m.transpose();
  }
};

// Points are summed by chunks of structures of arrays; the loops below have constant counts and no branches, so that the compiler makes vector
// code of them.
constexpr std::size_t chunk = 64;
using Coordinates = std::array<double, chunk>;
struct Chunk {
  alignas(64) Coordinates x, y, z;
  alignas(64) Coordinates counts;  // 1; 0 of a point that is not finite: there is no place that is far from every plane
};

// A value, or zero where `keep` is false. A conditional would be control flow to GCC 12, since a comparison may trap; a mask is not.
double keep_if(bool keep, double value) {
  return std::bit_cast<double>(std::bit_cast<std::int64_t>(value) & -static_cast<std::int64_t>(keep));
}

// Copies a chunk of points about the centre; what is not finite is put there, and does not count.
[[gnu::noinline]] void load(const CloudPoint* __restrict points, const Vec3& centre_m, Chunk& __restrict out) {
  const double cx = centre_m.x(), cy = centre_m.y(), cz = centre_m.z();
  for (std::size_t i = 0; i < chunk; ++i) {
    const double x = points[i].p_m.x(), y = points[i].p_m.y(), z = points[i].p_m.z();
    const bool good = finite(points[i]);
    out.x[i] = keep_if(good, x - cx);
    out.y[i] = keep_if(good, y - cy);
    out.z[i] = keep_if(good, z - cz);
    out.counts[i] = keep_if(good, 1.0);
  }
}

double dot(const Coordinates& a, const Coordinates& b) {
  constexpr std::size_t lanes = 8;
  std::array<double, lanes> sums{};
  for (std::size_t i = 0; i < chunk; i += lanes)
    for (std::size_t j = 0; j < lanes; ++j) sums[j] += a[i + j] * b[i + j];
  double total = 0;
  for (double s : sums) total += s;
  return total;
}

// A point counts in full within the window, and not beyond.
struct HardWindow {
  double window_m;
  double weight(double distance_m) const { return keep_if(std::abs(distance_m) < window_m, 1.0); }
};

// Tukey's biweight: a point counts less the farther it is, and not beyond the window.
struct SoftWindow {
  double window_m;
  double weight(double distance_m) const {
    const double square = distance_m * distance_m / (window_m * window_m);
    const double rest = 1 - (square < 1 ? square : 1.0);
    return rest * rest;
  }
};

// Adds the chunk's points, weighted by their distance to the plane.
template <class Window>
[[gnu::noinline]] void add(const Chunk& __restrict p, const Vec3& normal, double offset_m, Window window, Moments& m) {
  const double a = normal.x(), b = normal.y(), c = normal.z();
  alignas(64) Coordinates ones, weight, x, y, z;
  for (std::size_t i = 0; i < chunk; ++i) {
    const double w = p.counts[i] * window.weight(a * p.x[i] + b * p.y[i] + c * p.z[i] + offset_m);
    ones[i] = 1.0;
    weight[i] = w;
    x[i] = w * p.x[i];
    y[i] = w * p.y[i];
    z[i] = w * p.z[i];
  }
  m.n += dot(weight, ones);
  m.x += dot(x, ones);
  m.y += dot(y, ones);
  m.z += dot(z, ones);
  m.xx += dot(x, p.x);
  m.xy += dot(x, p.y);
  m.xz += dot(x, p.z);
  m.yy += dot(y, p.y);
  m.yz += dot(y, p.z);
  m.zz += dot(z, p.z);
}

template <class Window>
Moments moments_near(std::span<const CloudPoint> points, const Vec3& centre_m, const Vec3& normal, double offset_m, Window window) {
  Moments m;
  Chunk p;
  std::size_t i = 0;
  for (; i + chunk <= points.size(); i += chunk) {
    load(points.data() + i, centre_m, p);
    add(p, normal, offset_m, window, m);
  }
  std::array<CloudPoint, chunk> rest;
  rest.fill({.p_m = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN())});
  std::copy(points.begin() + i, points.end(), rest.begin());
  load(rest.data(), centre_m, p);
  add(p, normal, offset_m, window, m);
  return m;
}

// The total least squares plane. False when the points do not span one: nearly on a line (a single stripe, all of it in the laser's own
// plane, is a hundredth as wide as long), or as thick as they are wide.
bool solve(const Moments& m, Vec3& normal, double& offset_m) {
  if (!(m.n >= 3)) return false;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(m.covariance());
  const Vec3& spread = eigen.eigenvalues();  // ascending
  if (eigen.info() != Eigen::Success || !(spread(1) > 4 * spread(0)) || !(spread(1) > 1e-4 * spread(2))) return false;
  normal = eigen.eigenvectors().col(0).normalized();
  offset_m = -normal.dot(m.mean());
  return true;
}

// Median of the inliers' distances to the plane times 1.4826: the standard deviation of a normal distribution, which a proud plate hardly moves.
double robust_sigma(std::span<const CloudPoint> points, const Vec3& centre_m, const Vec3& normal, double offset_m, double threshold_m) {
  constexpr std::size_t bins = 256;
  std::array<std::uint32_t, bins> histogram{};
  std::uint32_t total = 0;
  for (const CloudPoint& point : points) {
    if (!finite(point)) continue;
    const double distance = std::abs(normal.dot(point.p_m.cast<double>() - centre_m) + offset_m);
    if (!(distance < threshold_m)) continue;
    ++histogram[std::min(bins - 1, static_cast<std::size_t>(distance / threshold_m * bins))];
    ++total;
  }
  std::uint32_t below = 0;
  std::size_t bin = 0;
  while (bin < bins && 2 * (below + histogram[bin]) < total) below += histogram[bin++];
  return 1.4826 * threshold_m * (static_cast<double>(bin) + 0.5) / bins;
}

// Total least squares fits to the points in the window until the plane stays; the normal keeps its side. False when they do not span a plane.
template <class Window>
bool refine(std::span<const CloudPoint> points, const Vec3& centre_m, Window window, Vec3& normal, double& offset_m) {
  for (int i = 0; i < max_refits; ++i) {
    const Moments m = moments_near(points, centre_m, normal, offset_m, window);
    const Vec3 before = normal;
    if (!solve(m, normal, offset_m)) return false;
    if (normal.dot(before) < 0) {
      normal = -normal;
      offset_m = -offset_m;
    }
    if ((normal - before).squaredNorm() < 1e-20) break;
  }
  return true;
}

}  // namespace

// One point out of each of equal runs of the cloud, at a random place in the run: all of the sweep is seen, whatever its order.
void PlaneFitter::gather(std::span<const CloudPoint> points, std::size_t finite_count, const Vec3& centre_m, std::uint64_t& random) {
  size_ = std::min(finite_count, subset_capacity);
  std::size_t index = 0, rank = 0;  // of the next point, and its rank among the finite ones
  for (std::size_t i = 0; i < size_; ++i) {
    const std::size_t begin = i * finite_count / size_, end = (i + 1) * finite_count / size_;
    const std::size_t wanted = begin + draw_below(random, end - begin);
    while (rank < wanted || !finite(points[index])) rank += finite(points[index++]) ? 1 : 0;
    const Vec3 p = points[index].p_m.cast<double>() - centre_m;
    x_[i] = static_cast<float>(p.x());
    y_[i] = static_cast<float>(p.y());
    z_[i] = static_cast<float>(p.z());
  }
}

// The MSAC cost: squared distances, each at most the squared threshold.
double PlaneFitter::score(const Hypothesis& h, float threshold_m) const {
  const float a = static_cast<float>(h.normal.x()), b = static_cast<float>(h.normal.y()), c = static_cast<float>(h.normal.z());
  const float d = static_cast<float>(h.offset_m), most = threshold_m * threshold_m;
  const auto cost = [&](std::size_t i) {
    const float distance = a * x_[i] + b * y_[i] + c * z_[i] + d;
    const float square = distance * distance;
    return square < most ? square : most;
  };
  alignas(64) std::array<float, block> sums{};
  std::size_t i = 0;
  for (; i + block <= size_; i += block)
    for (std::size_t j = 0; j < block; ++j) sums[j] += cost(i + j);
  for (std::size_t j = 0; i + j < size_; ++j) sums[j] += cost(i + j);
  double total = 0;
  for (float s : sums) total += static_cast<double>(s);
  return total;
}

std::size_t PlaneFitter::count(const Hypothesis& h, float threshold_m) const {
  const Eigen::Vector3f normal = h.normal.cast<float>();
  const float offset = static_cast<float>(h.offset_m);
  std::size_t inliers = 0;
  for (std::size_t i = 0; i < size_; ++i)
    inliers += std::abs(normal.x() * x_[i] + normal.y() * y_[i] + normal.z() * z_[i] + offset) < threshold_m ? 1 : 0;
  return inliers;
}

// Three points of the subset make a plane, unless they are nearly on a line.
bool PlaneFitter::draw(std::uint64_t& random, Hypothesis& h) const {
  const std::size_t i = draw_below(random, size_), j = draw_below(random, size_), k = draw_below(random, size_);
  const Vec3 p(x_[i], y_[i], z_[i]);
  const Vec3 e1 = Vec3(x_[j], y_[j], z_[j]) - p, e2 = Vec3(x_[k], y_[k], z_[k]) - p;
  const Vec3 normal = e1.cross(e2);
  const double square = normal.squaredNorm();
  if (!(square > 1e-8 * e1.squaredNorm() * e2.squaredNorm())) return false;
  h.normal = normal / std::sqrt(square);
  h.offset_m = -h.normal.dot(p);
  return true;
}

// Two least-squares steps over the subset's inliers, kept if they lower the score: three noisy points make a tilted plane.
void PlaneFitter::refine_on_subset(Hypothesis& h, float threshold_m) const {
  for (int step = 0; step < 2; ++step) {
    Moments m;
    for (std::size_t i = 0; i < size_; ++i) {
      const double x = x_[i], y = y_[i], z = z_[i];
      if (!(std::abs(h.normal.x() * x + h.normal.y() * y + h.normal.z() * z + h.offset_m) < threshold_m)) continue;
      m = {m.n + 1, m.x + x, m.y + y, m.z + z, m.xx + x * x, m.xy + x * y, m.xz + x * z, m.yy + y * y, m.yz + y * z, m.zz + z * z};
    }
    Hypothesis refined;
    if (!solve(m, refined.normal, refined.offset_m)) return;
    refined.score = score(refined, threshold_m);
    if (!(refined.score < h.score)) return;
    h = refined;
  }
}

bool PlaneFitter::best_hypothesis(const Config& config, std::uint64_t& random, Hypothesis& best) const {
  const float threshold_m = static_cast<float>(config.threshold_m);
  double needed = config.hypotheses;
  for (std::uint32_t i = 0; i < config.hypotheses && i < needed; ++i) {
    Hypothesis h;
    if (!draw(random, h)) continue;
    h.score = score(h, threshold_m);
    if (!(h.score < best.score)) continue;
    refine_on_subset(h, threshold_m);
    best = h;
    // 99.99 % sure of one draw of three good inliers; a fifth of those counted are outliers by chance, or too noisy to draw a plane with.
    const double inliers = 0.8 * static_cast<double>(count(best, threshold_m)) / static_cast<double>(size_);
    const double all_three = inliers * inliers * inliers;
    needed = std::log(1e-4) / std::log1p(-std::min(all_three, 0.99));
  }
  return std::isfinite(best.score);
}

PlaneFit PlaneFitter::fit(std::span<const CloudPoint> points, const Config& config) {
  PlaneFit result;
  if (!(config.threshold_m > 0) || !std::isfinite(config.threshold_m)) return result;
  Vec3 centre_m = Vec3::Zero();
  for (const CloudPoint& point : points) {
    if (!finite(point)) continue;
    centre_m += point.p_m.cast<double>();
    ++result.points;
  }
  if (result.points < 3) return result;
  centre_m /= result.points;

  std::uint64_t random = config.seed;
  gather(points, result.points, centre_m, random);
  Hypothesis best;
  if (!best_hypothesis(config, random, best)) return result;
  Vec3 normal = best.normal;
  double offset_m = best.offset_m;
  if (!refine(points, centre_m, HardWindow{window_thresholds * config.threshold_m}, normal, offset_m)) return result;
  if (config.tight_sigmas > 0) {
    const double sigma_m = robust_sigma(points, centre_m, normal, offset_m, config.threshold_m);
    const double window_m = std::min(window_thresholds * config.threshold_m, config.tight_sigmas * sigma_m);
    if (!refine(points, centre_m, SoftWindow{window_m}, normal, offset_m)) return result;
  }

  const Moments near = moments_near(points, centre_m, normal, offset_m, HardWindow{config.threshold_m});
  if (!(near.n >= std::min<double>(4, result.points))) return result;
  const Vec3 mean = near.mean();
  const double mean_distance = normal.dot(mean) + offset_m;
  result.rms_m = std::sqrt(std::max(0.0, normal.dot(near.covariance() * normal) + mean_distance * mean_distance));
  result.inliers = static_cast<std::uint32_t>(near.n);
  result.plane.normal = normal;
  result.plane.offset_m = offset_m - normal.dot(centre_m);
  if (result.plane.signed_distance_m(config.toward_m) < 0) {
    result.plane.normal = -result.plane.normal;
    result.plane.offset_m = -result.plane.offset_m;
  }
  const PlaneBend bend = plane_bend(points, result.plane, config.threshold_m);
  result.bend_m = bend.bend_m;
  result.seen_m = bend.seen_m;
  result.valid = true;
  return result;
}

}  // namespace lf::scan
