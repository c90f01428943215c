// The limits no mission may pass, from a file of their own.
//
// The file carries a checksum of its values; the core computes it again and refuses to move when the two differ. A mission can tighten a
// limit, never widen it.
#pragma once

#include <array>
#include <cstdint>

#include "shared/geometry/pose.hpp"
#include "shared/messages/capacity.hpp"
#include "shared/messages/static_vector.hpp"
#include "shared/messages/time.hpp"

namespace lf::safety {

struct JointLimit {
  double min_rad = 0;
  double max_rad = 0;
  double max_speed_rad_s = 0;
  double max_torque_nm = 0;

  bool operator==(const JointLimit&) const = default;
};

struct Limits {
  StaticVector<JointLimit, capacity::joints> joints;
  // The tool point stays inside this box of the base frame. Its X bound is the panel's farthest face: touching is the guarded motions' business.
  std::array<double, 3> workspace_min_m{};
  std::array<double, 3> workspace_max_m{};
  double stale_position_s = 0;       // a drive's position older than this is a fault; three SYNC cycles
  double stale_image_s = 0;          // an exposure whose image is later than this is lost
  double vision_timeout_s = 0;       // panel vision's answer
  double max_contact_torque_nm = 0;  // over the free-motion baseline, on any arm joint, outside the gripping and pressing steps

  std::uint32_t checksum = 0;  // CRC-32 of the values above, see limits_checksum()

  bool operator==(const Limits&) const = default;
};

// CRC-32 (IEEE 802.3, reflected) over the values in their order above, each as the 8 little-endian bytes of its IEEE 754 double.
std::uint32_t limits_checksum(const Limits& limits);

enum class LimitsVerdict : std::uint8_t { good, wrong_checksum, not_a_number, out_of_order, not_positive };

// What is wrong with them, if anything. Only good limits may be used.
LimitsVerdict check(const Limits& limits);
const char* name(LimitsVerdict verdict);

// How far a point of the base frame lies outside the workspace, along the axis on which it is farthest out; 0 inside. Infinite when it is not a number.
double workspace_excursion_m(const Limits& limits, const Vec3& point_m);

// `tighter` within `limits`: every range inside the other's, every bound at most the other's. A mission's own limits are accepted only so.
bool is_tighter(const Limits& tighter, const Limits& limits);

}  // namespace lf::safety
