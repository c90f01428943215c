#include "firmware/scan/plane.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace lf::scan {

// normal . p + offset = 0 about the cloud's centre.
struct PlaneFitter::Hypothesis {
  Vec3 normal = Vec3::UnitZ();
  double offset_m = 0;
  double score = std::numeric_limits<double>::infinity();
};

namespace {

constexpr std::size_t block = 16;    // floats that GCC keeps in two AVX registers
constexpr float far_away_m = 1e15f;  // no inlier of any plane, and its square is still a float
constexpr int max_refits = 20;       // 3 to 6 are usual; the set of inliers may flip between two of equal merit

// Steele, Lea, Flood, OOPSLA 2014.
std::uint64_t splitmix(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9E3779B97F4A7C15u);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

// Uniform in 0..n-1, n < 2^32; biased by less than n / 2^32.
std::size_t draw_below(std::uint64_t& state, std::size_t n) { return static_cast<std::size_t>(((splitmix(state) >> 32) * n) >> 32); }

bool finite(const CloudPoint& point) {
  const Eigen::Vector3f& p = point.p_m;
  return (p.x() - p.x()) + (p.y() - p.y()) + (p.z() - p.z()) == 0;  // infinity less itself is not a number
}

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

constexpr std::size_t chunk = 64;
constexpr std::size_t accumulators = 4;  // doubles in an AVX register
struct Lanes {
  alignas(64) std::array<std::array<double, accumulators>, 10> sums{};
};

// Adds a chunk's points within `threshold` of the plane: no branch, so that the compiler makes vector code of it.
[[gnu::noinline]] void add_chunk(const double* __restrict x, const double* __restrict y, const double* __restrict z, const Vec3& normal,
                                 double offset, double threshold, Lanes& lanes) {
  const double a = normal.x(), b = normal.y(), c = normal.z();
  auto& s = lanes.sums;
  for (std::size_t i = 0; i < chunk; i += accumulators) {
    for (std::size_t j = 0; j < accumulators; ++j) {
      const double distance = a * x[i + j] + b * y[i + j] + c * z[i + j] + offset;
      const double w = std::abs(distance) < threshold ? 1.0 : 0.0;
      const double wx = w * x[i + j], wy = w * y[i + j], wz = w * z[i + j];
      s[0][j] += w;
      s[1][j] += wx;
      s[2][j] += wy;
      s[3][j] += wz;
      s[4][j] += wx * x[i + j];
      s[5][j] += wx * y[i + j];
      s[6][j] += wx * z[i + j];
      s[7][j] += wy * y[i + j];
      s[8][j] += wy * z[i + j];
      s[9][j] += wz * z[i + j];
    }
  }
}

// Copies up to a chunk of points about the centre; what is not finite, and the rest of the chunk, is put far away.
void load_chunk(std::span<const CloudPoint> points, const Vec3& centre_m, double* __restrict x, double* __restrict y,
                double* __restrict z) {
  for (std::size_t i = 0; i < chunk; ++i) {
    const bool good = i < points.size() && finite(points[i]);
    x[i] = good ? static_cast<double>(points[i].p_m.x()) - centre_m.x() : static_cast<double>(far_away_m);
    y[i] = good ? static_cast<double>(points[i].p_m.y()) - centre_m.y() : static_cast<double>(far_away_m);
    z[i] = good ? static_cast<double>(points[i].p_m.z()) - centre_m.z() : static_cast<double>(far_away_m);
  }
}

Moments moments_near(std::span<const CloudPoint> points, const Vec3& centre_m, const Vec3& normal, double offset_m, double threshold_m) {
  Lanes lanes;
  alignas(64) std::array<double, chunk> x, y, z;
  for (std::size_t i = 0; i < points.size(); i += chunk) {
    load_chunk(points.subspan(i, std::min(chunk, points.size() - i)), centre_m, x.data(), y.data(), z.data());
    add_chunk(x.data(), y.data(), z.data(), normal, offset_m, threshold_m, lanes);
  }
  std::array<double, 10> t{};
  for (std::size_t k = 0; k < t.size(); ++k)
    for (double lane : lanes.sums[k]) t[k] += lane;
  return {t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7], t[8], t[9]};
}

// The total least squares plane. False when the points do not span one: nearly on a line, or as thick as they are wide.
bool solve(const Moments& m, Vec3& normal, double& offset_m) {
  if (!(m.n >= 3)) return false;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(m.covariance());
  const Vec3 spread = eigen.eigenvalues();  // ascending
  if (eigen.info() != Eigen::Success || !(spread(1) > 4 * spread(0)) || !(spread(1) > 1e-8 * spread(2))) return false;
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

// Refits over all points near the plane until their number and the plane stay. False when they stop spanning a plane.
bool refit(std::span<const CloudPoint> points, const Vec3& centre_m, double threshold_m, Vec3& normal, double& offset_m) {
  double inliers = -1;
  for (int i = 0; i < max_refits; ++i) {
    const Moments m = moments_near(points, centre_m, normal, offset_m, threshold_m);
    const Vec3 before = normal;
    if (!solve(m, normal, offset_m)) return false;
    if (normal.dot(before) < 0) {
      normal = -normal;
      offset_m = -offset_m;
    }
    if (m.n == inliers && (normal - before).squaredNorm() < 1e-20) return true;
    inliers = m.n;
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
  for (std::size_t i = size_; i < subset_capacity && i % block != 0; ++i) x_[i] = y_[i] = z_[i] = far_away_m;
}

// The MSAC cost: squared distances, each at most the squared threshold.
double PlaneFitter::score(const Hypothesis& h, float threshold_m) const {
  const float a = static_cast<float>(h.normal.x()), b = static_cast<float>(h.normal.y()), c = static_cast<float>(h.normal.z());
  const float d = static_cast<float>(h.offset_m), most = threshold_m * threshold_m;
  alignas(64) std::array<float, block> sums{};
  for (std::size_t i = 0; i < size_; i += block)
    for (std::size_t j = 0; j < block; ++j) {
      const float distance = a * x_[i + j] + b * y_[i + j] + c * z_[i + j] + d;
      const float square = distance * distance;
      sums[j] += square < most ? square : most;
    }
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
  if (!refit(points, centre_m, config.threshold_m, normal, offset_m)) return result;
  if (config.tight_sigmas > 0) {
    const double sigma_m = robust_sigma(points, centre_m, normal, offset_m, config.threshold_m);
    const double window_m = std::min(config.threshold_m, config.tight_sigmas * sigma_m);
    if (!refit(points, centre_m, window_m, normal, offset_m)) return result;
  }

  const Moments inliers = moments_near(points, centre_m, normal, offset_m, config.threshold_m);
  if (!(inliers.n >= std::min<double>(4, result.points))) return result;
  const Vec3 mean = inliers.mean();
  const double mean_distance = normal.dot(mean) + offset_m;
  result.rms_m = std::sqrt(std::max(0.0, normal.dot(inliers.covariance() * normal) + mean_distance * mean_distance));
  result.inliers = static_cast<std::uint32_t>(inliers.n);
  result.plane.normal = normal;
  result.plane.offset_m = offset_m - normal.dot(centre_m);
  if (result.plane.signed_distance_m(config.toward_m) < 0) {
    result.plane.normal = -result.plane.normal;
    result.plane.offset_m = -result.plane.offset_m;
  }
  result.valid = true;
  return result;
}

}  // namespace lf::scan
