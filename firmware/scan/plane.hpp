// The plane that most points of a cloud lie on, whatever the rest does.
//
// Hypotheses of three points are scored by MSAC (Torr and Zisserman, CVIU 2000) over a subset gathered at random from the whole cloud: a sweep
// orders its points, and a contiguous or strided subset sees a part of the panel only. A hypothesis that is better than all before is refined on
// the subset at once (Chum, Matas, Kittler, DAGM 2003), the best of all by total least squares
// over the points within twice the threshold.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/messages/panel_vision.hpp"

namespace lf::scan {

class PlaneFitter {
 public:
  // At 85 % outliers 307 inliers: enough to rank hypotheses, and it fits the first-level cache.
  static constexpr std::size_t subset_capacity = 2048;

  struct Config {
    double threshold_m = 0.003;       // inliers are nearer than this
    std::uint64_t seed = 1;           // of the subset and the hypotheses
    std::uint32_t hypotheses = 4096;  // at most: at 85 % outliers 99.99 % sure of three inliers takes 2700
    // > 0: the last refits weight the points by Tukey's biweight with a window of so many robust standard deviations (4.7 is 95 % efficient, 3 is 73 %), so
    // that a marker plate 2 mm proud does not pull; 0 is plain least squares.
    double tight_sigmas = 0;
    Vec3 toward_m = Vec3::Zero();  // the normal points to the side of this point
  };

  // Fits a plane to `points`; NaN and infinite ones are passed over, and count as neither points nor inliers.
  // Not valid: fewer than 3 finite points, all of them in one place or along one line, a threshold that is not positive.
  // Deterministic; the same points in another order give the same inliers, and the same plane to rounding. No allocation.
  // O(points + hypotheses * subset): 0.5..3 ms for 100,000 points.
  PlaneFit fit(std::span<const CloudPoint> points, const Config& config);

 private:
  struct Hypothesis;
  void gather(std::span<const CloudPoint> points, std::size_t finite, const Vec3& centre_m, std::uint64_t& random);
  double score(const Hypothesis& h, float threshold_m) const;
  std::size_t count(const Hypothesis& h, float threshold_m) const;
  bool draw(std::uint64_t& random, Hypothesis& h) const;
  void refine_on_subset(Hypothesis& h, float threshold_m) const;
  bool best_hypothesis(const Config& config, std::uint64_t& random, Hypothesis& best) const;

  // Structure of arrays, about the cloud's centre.
  alignas(64) std::array<float, subset_capacity> x_{}, y_{}, z_{};
  std::size_t size_ = 0;
};

}  // namespace lf::scan
