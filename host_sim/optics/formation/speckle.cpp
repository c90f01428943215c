#include "host_sim/optics/formation/speckle.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/optics/formation/normal_deviates.hpp"
#include "shared/lanes/lanes.hpp"
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

void Speckle::factors(std::uint32_t first, std::size_t count, float* out) const {
  constexpr std::size_t block = 64;
  std::array<float, block> sum, deviates;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t size = std::min(count - begin, block);
    sum.fill(0);
    for (std::size_t corner = 0; corner < key_.size(); ++corner) {
      if (share_[corner] == 0.f) continue;
      normal_deviates(first + static_cast<std::uint32_t>(begin), size, key_[corner], deviates.data());
      for (std::size_t i = 0; i < size; i += lane_count)
        store_lanes(sum.data() + i, load_lanes(sum.data() + i) + share_[corner] * load_lanes(deviates.data() + i));
    }
    for (std::size_t i = 0; i < size; i += lane_count) {
      const Lanes root = max(mean_ + slope_ * load_lanes(sum.data() + i), Lanes{});
      store_lanes(out + begin + i, root * root * root);
    }
  }
}

}  // namespace lf::optics
