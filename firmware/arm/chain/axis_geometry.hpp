// Which closed form a chain's axes allow. Told by where the axes lie at joint values 0, never by joints' names.
//
// Axes count as parallel or meeting within 1e-5 rad and 1e-5 m: descriptions write angles with 4 to 10 digits. What that leaves is mended on the
// true chain.
#pragma once

#include "firmware/arm/chain/chain.hpp"

namespace lf::chain {

enum class Family : std::uint8_t {
  numeric,          // none of the others
  planar,           // 4R, 5R: a first joint, two or three parallel ones, and a last one for what is left
  spherical_wrist,  // 6R: joints 2 and 3 parallel, 4 to 6 meet in a point (PUMA, Oberon)
  three_parallel,   // 6R: joints 2, 3 and 4 parallel, 5 and 6 meet (UR)
};
const char* name(Family family);

struct AxisGeometry {
  Family family = Family::numeric;
  const char* reason = "";  // one sentence, for the people who ask why

  // At joint values 0, base frame. The axes as they are, but for those of the parallel joints, which are that of the second, once.
  std::array<Vec3, max_joints> axis{};
  std::array<Vec3, max_joints> point_m{};
  std::array<double, max_joints> sense{};  // -1 where a parallel joint turns the other way than the second
  Mat3 tool = Mat3::Identity();
  Vec3 tool_m = Vec3::Zero();
  Vec3 centre_m = Vec3::Zero();  // where the last three, or two, axes meet
  int parallel = 0;              // how many of the joints from the second on
  bool tool_on_last = false;     // planar with a roll: the tool point and its approach axis are on the last axis
};

AxisGeometry classify(const Chain& chain);

}  // namespace lf::chain
