// The plane that most points of a cloud lie on, whatever the rest does.
//
// Hypotheses of three points are scored by MSAC (Torr and Zisserman, CVIU 2000) over a subset gathered at random from the whole cloud: a sweep
// orders its points, and a contiguous or strided subset sees a part of the panel only. The best hypothesis is then refined by total least squares
// over all its inliers, again and again until they no longer change.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/messages/panel_vision.hpp"

namespace lf::scan {

class PlaneFitter {
 public:
  static constexpr std::size_t subset_capacity =
      2048;  // at 85 % outliers 307 inliers: enough to rank hypotheses, and it fits the first-level cache

  struct Config {
    double threshold_m = 0.003;       // inliers are nearer than this
    std::uint64_t seed = 1;           // of the subset and the hypotheses
    std::uint32_t hypotheses = 2048;  // at most; at 85 % outliers 99.9 % sure. Fewer when the inliers found allow the same certainty
    double tight_sigmas = 0;          // > 0: the last refits keep only points within this many robust standard deviations of the plane, so
                                      // that a marker plate 2 mm proud does not pull; 0 keeps the inliers
    Vec3 toward_m = Vec3::Zero();     // the normal points to the side of this point
  };

  // Fits a plane to `points`; NaN and infinite ones are passed over, and count as neither points nor inliers.
  // Not valid: fewer than 3 finite points, all of them on one line or in one place, or no three that agree with a fourth where there is one.
  // The same points in another order give the same plane up to the choice of the subset. No allocation; O(points + hypotheses * subset).
  PlaneFit fit(std::span<const CloudPoint> points, const Config& config);

 private:
  struct Subset {
    alignas(64) std::array<float, subset_capacity> x, y, z;
    std::size_t size = 0;
  };
  Subset subset_;
};

}  // namespace lf::scan
