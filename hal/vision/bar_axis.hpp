// The direction of a bar from points on its top, sampled by a laser in stripes.
#pragma once

#include <span>

#include "shared/geometry/pose.hpp"

namespace lf::vision {

struct BarAxis {
  Vec2 centre = Vec2::Zero();
  Vec2 direction = Vec2::UnitX();
};

BarAxis bar_axis(std::span<const Vec2> points);

}  // namespace lf::vision
