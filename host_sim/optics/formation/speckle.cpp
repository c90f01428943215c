#include "host_sim/optics/formation/speckle.hpp"

#include <cmath>

#include "shared/random.hpp"

namespace lf::optics {

Speckle::Speckle(double contrast, std::uint64_t key, const Vec3& emitter_m)
    : mean_(static_cast<float>(1 - contrast * contrast / 9)), slope_(static_cast<float>(contrast / 3)) {
  const Vec3 cell = emitter_m / grain_move_m;
  const Vec3 first = cell.array().floor();
  for (std::size_t corner = 0; corner < key_.size(); ++corner) {
    double share = 1;
    std::uint64_t hash = key;
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (corner >> axis & 1) != 0;
      const double past = cell[axis] - first[axis];
      share *= upper ? past : 1 - past;
      hash = splitmix64(hash + static_cast<std::uint64_t>(static_cast<std::int64_t>(first[axis]) + (upper ? 1 : 0)));
    }
    key_[corner] = hash;
    share_[corner] = static_cast<float>(std::sqrt(share));  // their squares add up to 1: so does the variance
  }
}

Lanes Speckle::factor(WordLanes pixel) const {
  Lanes deviate{};
  for (std::size_t corner = 0; corner < key_.size(); ++corner) {
    if (share_[corner] > 0.f) deviate += share_[corner] * normal_deviates(pixel, key_[corner]);
  }
  const Lanes root = max(mean_ + slope_ * deviate, Lanes{});
  return root * root * root;
}

}  // namespace lf::optics
