#include "host_sim/app/plane_doubt.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace lf::app {

namespace {

// The fit is made for up to 85 % outliers: beyond these a chance plane may have as many inliers as the true one.
constexpr double fewest_share = 0.15;
// 1 sigma of the normal, from the inliers' scatter and spread.
constexpr double unsure_deg = 1;
// What stands before an arm is metres wide: hundreds are millimetres.
constexpr double widest_m = 100;

std::string formatted(const char* format, double a, double b = 0, double c = 0) {
  std::array<char, 240> text;
  (void)std::snprintf(text.data(), text.size(), format, a, b, c);
  return text.data();
}

double widest_extent_m(std::span<const CloudPoint> points) {
  Vec3 low = Vec3::Constant(HUGE_VAL), high = Vec3::Constant(-HUGE_VAL);
  for (const CloudPoint& point : points) {
    if (!point.p_m.allFinite()) continue;
    low = low.cwiseMin(point.p_m.cast<double>());
    high = high.cwiseMax(point.p_m.cast<double>());
  }
  return (high - low).maxCoeff();
}

// How well the normal is known about the inliers' long axis: scatter over spread across it and the root of their number.
double normal_sigma_deg(std::span<const CloudPoint> points, const PlaneFit& fit, double threshold_m) {
  std::vector<Vec3> inliers;
  Vec3 mean = Vec3::Zero();
  for (const CloudPoint& point : points) {
    const Vec3 p = point.p_m.cast<double>();
    if (!p.allFinite() || std::abs(fit.plane.signed_distance_m(p)) > threshold_m) continue;
    inliers.push_back(p);
    mean += p;
  }
  if (inliers.size() < 3) return 90;
  mean /= static_cast<double>(inliers.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : inliers) spread += (p - mean) * (p - mean).transpose();
  spread /= static_cast<double>(inliers.size());
  const Vec3 variance =
      Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvalues();  // ascending: the scatter, then the plane's short and long axis
  const double across_m = std::sqrt(std::max(variance[1], 0.0)), scatter_m = std::sqrt(std::max(variance[0], 0.0));
  if (across_m <= 0) return 90;
  return deg_from_rad(std::atan(scatter_m / (across_m * std::sqrt(static_cast<double>(inliers.size())))));
}

}  // namespace

std::vector<std::string> plane_doubts(std::span<const CloudPoint> points, const PlaneFit& fit, double threshold_m) {
  std::vector<std::string> doubts;
  const double extent_m = widest_extent_m(points);
  const std::string unit =
      extent_m > widest_m ? formatted("; the cloud is %.0f m wide: is it in millimetres? Clouds are in metres", extent_m) : "";
  if (fit.inliers < fewest_share * fit.points) {
    doubts.push_back(formatted("only %.0f of %.0f points lie within %.3g mm of the plane", fit.inliers, fit.points, 1e3 * threshold_m) +
                     unit);
  } else if (!unit.empty()) {
    doubts.push_back(unit.substr(2));
  }
  if (const double sigma_deg = normal_sigma_deg(points, fit, threshold_m); sigma_deg > unsure_deg)
    doubts.push_back(formatted("the points on the plane lie along a line: its normal is known to %.1f degrees only", sigma_deg));
  return doubts;
}

}  // namespace lf::app
