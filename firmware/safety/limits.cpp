#include "firmware/safety/limits.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lf::safety {

namespace {

// Calls `visit` with every value in the order of the checksum.
template <class Visit>
void for_each_value(const Limits& limits, Visit visit) {
  for (const JointLimit& joint : limits.joints) {
    visit(joint.min_rad);
    visit(joint.max_rad);
    visit(joint.max_speed_rad_s);
    visit(joint.max_torque_nm);
  }
  for (double bound : limits.workspace_min_m) visit(bound);
  for (double bound : limits.workspace_max_m) visit(bound);
  visit(limits.stale_position_s);
  visit(limits.stale_image_s);
  visit(limits.vision_timeout_s);
  visit(limits.max_contact_torque_nm);
}

std::uint32_t crc32_byte(std::uint32_t crc, std::uint8_t byte) {
  constexpr std::uint32_t reflected_polynomial = 0xEDB88320u;
  crc ^= byte;
  for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) ? reflected_polynomial : 0u);
  return crc;
}

}  // namespace

std::uint32_t limits_checksum(const Limits& limits) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for_each_value(limits, [&crc](double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int byte = 0; byte < 8; ++byte) crc = crc32_byte(crc, static_cast<std::uint8_t>(bits >> (8 * byte)));
  });
  return ~crc;
}

LimitsVerdict check(const Limits& limits) {
  bool finite = true;
  for_each_value(limits, [&finite](double value) { finite = finite && std::isfinite(value); });
  if (!finite) return LimitsVerdict::not_a_number;
  for (const JointLimit& joint : limits.joints) {
    if (joint.min_rad >= joint.max_rad) return LimitsVerdict::out_of_order;
    if (joint.max_speed_rad_s <= 0 || joint.max_torque_nm <= 0) return LimitsVerdict::not_positive;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (limits.workspace_min_m[axis] >= limits.workspace_max_m[axis]) return LimitsVerdict::out_of_order;
  }
  if (limits.stale_position_s <= 0 || limits.stale_image_s <= 0 || limits.vision_timeout_s <= 0 || limits.max_contact_torque_nm <= 0) {
    return LimitsVerdict::not_positive;
  }
  return limits_checksum(limits) == limits.checksum ? LimitsVerdict::good : LimitsVerdict::wrong_checksum;
}

const char* name(LimitsVerdict verdict) {
  switch (verdict) {
    case LimitsVerdict::good: return "good";
    case LimitsVerdict::wrong_checksum: return "wrong checksum";
    case LimitsVerdict::not_a_number: return "not a number";
    case LimitsVerdict::out_of_order: return "minimum above maximum";
    case LimitsVerdict::not_positive: return "not positive";
  }
  return "unknown";
}

double workspace_excursion_m(const Limits& limits, const Vec3& point_m) {
  if (!point_m.allFinite()) return HUGE_VAL;
  double farthest_m = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = point_m[static_cast<Eigen::Index>(axis)];
    farthest_m = std::max({farthest_m, limits.workspace_min_m[axis] - x, x - limits.workspace_max_m[axis]});
  }
  return farthest_m;
}

bool is_tighter(const Limits& tighter, const Limits& limits) {
  if (tighter.joints.size() != limits.joints.size()) return false;
  for (std::size_t i = 0; i < limits.joints.size(); ++i) {
    const JointLimit& inner = tighter.joints[i];
    const JointLimit& outer = limits.joints[i];
    if (!(inner.min_rad >= outer.min_rad && inner.max_rad <= outer.max_rad)) return false;
    if (!(inner.max_speed_rad_s <= outer.max_speed_rad_s && inner.max_torque_nm <= outer.max_torque_nm)) return false;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(tighter.workspace_min_m[axis] >= limits.workspace_min_m[axis])) return false;
    if (!(tighter.workspace_max_m[axis] <= limits.workspace_max_m[axis])) return false;
  }
  return tighter.stale_position_s <= limits.stale_position_s && tighter.stale_image_s <= limits.stale_image_s &&
         tighter.vision_timeout_s <= limits.vision_timeout_s && tighter.max_contact_torque_nm <= limits.max_contact_torque_nm;
}

}  // namespace lf::safety
