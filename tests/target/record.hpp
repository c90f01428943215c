// A recorded mission as a byte stream: what the controller was told, what came in at every tick, and what it answered.
//
// `pass` walks a struct's fields in their order, for the writer and for the reader alike; structured bindings let it not compile when a field is
// added and forgotten here. Little-endian; nothing whose size depends on the processor.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "firmware/config.hpp"
#include "firmware/telemetry.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/panel_vision.hpp"
#include "shared/messages/scan_messages.hpp"
#include "shared/messages/static_vector.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::test {

inline constexpr std::uint32_t record_magic = 0x324D464Cu;  // "LFM2"

// A stream has bytes(void*, size): a writer takes from there, a reader puts there; and broken(), which ends the program. It derives from this one, by
// which argument-dependent lookup finds every `pass`.
struct RecordStream {};

template <class S, class T>
requires std::is_arithmetic_v<T> || std::is_enum_v<T>
void pass(S& s, T& value) {
  static_assert(sizeof(T) <= 8 && !std::is_same_v<T, long double>);
  s.bytes(&value, sizeof value);
}

template <class S>
void pass(S& s, Time& t) {
  std::int64_t ns = t.ns();
  pass(s, ns);
  t = Time::from_ns(ns);
}
template <class S>
void pass(S& s, Duration& d) {
  std::int64_t ns = d.ns();
  pass(s, ns);
  d = Duration::from_ns(ns);
}
template <class S, class Derived>
void pass(S& s, Eigen::PlainObjectBase<Derived>& m) {
  for (auto& coefficient : m.reshaped()) pass(s, coefficient);
}
// Builds differ in how many joints they have room for: those of the recorded arm are passed.
template <class S>
void pass(S& s, arm::JointVector& of_joints) {
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(arm5e_joint::of_arm); ++i) pass(s, of_joints[i]);
}
template <class S, class T, std::size_t N>
void pass_first(S& s, std::array<T, N>& items, std::size_t count) {
  if (count > N) return s.broken();
  for (std::size_t i = 0; i < count; ++i) pass(s, items[i]);
}
template <class S>
void pass(S& s, Pose& pose) {
  pass(s, pose.matrix());
}
template <class S, class T, std::size_t N>
void pass(S& s, std::array<T, N>& items) {
  for (T& item : items) pass(s, item);
}
template <class S, class T, std::size_t N>
void pass(S& s, StaticVector<T, N>& items) {
  std::uint32_t size = static_cast<std::uint32_t>(items.size());
  pass(s, size);
  // In place: an answer of panel vision is too big for a small stack.
  while (items.size() > size) items.pop_back();
  while (items.size() < size)
    if (items.extend() == nullptr) return s.broken();
  for (T& item : items) pass(s, item);
}

template <class S, class... Fields>
void pass_all(S& s, Fields&... fields) {
  (pass(s, fields), ...);
}

template <class S>
void pass(S& s, CanFrame& v) {
  auto& [id, length, data] = v;
  pass_all(s, id, length, data);
}

// The configuration.
template <class S>
void pass(S& s, canopen::Identity& v) {
  auto& [vendor, product] = v;
  pass_all(s, vendor, product);
}
template <class S>
void pass(S& s, canopen::Ratio& v) {
  auto& [num, den] = v;
  pass_all(s, num, den);
}
template <class S>
void pass(S& s, canopen::DriveScale& v) {
  auto& [position, speed, acceleration, torque, sign] = v;
  pass_all(s, position, speed, acceleration, torque, sign);
}
template <class S>
void pass(S& s, canopen::BootStep& v) {
  auto& [index, sub, width, action, value, literal, mask, optional, best_effort] = v;
  pass_all(s, index, sub, width, action, value, literal, mask, optional, best_effort);
}
template <class S>
void pass(S& s, canopen::Absence& v) {
  auto& [what, by, index, sub] = v;
  pass_all(s, what, by, index, sub);
}
template <class S>
void pass(S& s, canopen::DriveProfile& v) {
  auto& [scale, rated_unit, rated, guarded, torque_offset, waits, times_following, brake_opens, brake_closes, quick_stop_fallback,
         abort_fallback, objects, absences, position_lost] = v;
  pass_all(s, scale, rated_unit, rated, guarded, torque_offset, waits, times_following, brake_opens, brake_closes, quick_stop_fallback,
           abort_fallback, objects, absences, position_lost);
}
template <class S>
void pass(S& s, canopen::DriveSetup& v) {
  auto& [node, identity, profile, min_counts, max_counts, drive_margin, max_torque, described, max_speed, motor_speed, quick_stop, window,
         timeout, quick_stop_option, abort_option, encoder_zero, zero_known, homing_method, home_offset, homing_speed, homing_accel,
         homing_timeout] = v;
  pass_all(s, node, identity, profile, min_counts, max_counts, drive_margin, max_torque, described, max_speed, motor_speed, quick_stop,
           window, timeout, quick_stop_option, abort_option, encoder_zero, zero_known, homing_method, home_offset, homing_speed,
           homing_accel, homing_timeout);
}
template <class S>
void pass(S& s, canopen::IoSetup& v) {
  auto& [node, identity] = v;
  pass_all(s, node, identity);
}
template <class S>
void pass(S& s, canopen::NetworkConfig& v) {
  auto& [drives, io, sync_period, sdo_timeout, retries, boot_up_timeout, start_timeout, transition_timeout] = v;
  pass_all(s, drives, io, sync_period, sdo_timeout, retries, boot_up_timeout, start_timeout, transition_timeout);
}
template <class S>
void pass(S& s, CameraIntrinsics& v) {
  auto& [width, height, fx, fy, cx, cy, distortion] = v;
  pass_all(s, width, height, fx, fy, cx, cy, distortion);
}
template <class S>
void pass(S& s, CameraCalibration& v) {
  auto& [intrinsics, base_from_camera, exposure] = v;
  pass_all(s, intrinsics, base_from_camera, exposure);
}
template <class S>
void pass(S& s, LaserCalibration& v) {
  auto& [tool_from_laser, fan] = v;
  pass_all(s, tool_from_laser, fan);
}
template <class S>
void pass(S& s, MarkerCalibration& v) {
  auto& [id, size_m, panel_from_tag] = v;
  pass_all(s, id, size_m, panel_from_tag);
}
template <class S>
void pass(S& s, mission::Task& v) {
  auto& [kind, to_rad, button, valve] = v;
  pass_all(s, kind, to_rad, button, valve);
}
template <class S>
void pass(S& s, PanelLayout::Valve& v) {
  auto& [at_m, length, thickness, height, pointer, carried, depth, pointer_length, min_rad, max_rad, stem] = v;
  pass_all(s, at_m, length, thickness, height, pointer, carried, depth, pointer_length, min_rad, max_rad, stem);
}
template <class S>
void pass(S& s, PanelLayout::Button& v) {
  auto& [at_m, width, height, stroke] = v;
  pass_all(s, at_m, width, height, stroke);
}
template <class S>
void pass(S& s, PanelLayout::Marker& v) {
  auto& [id, size, plate, thickness, centre] = v;
  pass_all(s, id, size, plate, thickness, centre);
}
template <class S>
void pass(S& s, PanelLayout& v) {
  auto& [x, y, z, plate_min, plate_max, plate_thickness, valves, buttons, markers] = v;
  pass_all(s, x, y, z, plate_min, plate_max, plate_thickness, valves, buttons, markers);
}
template <class S>
void pass(S& s, arm::PanelDoubt& v) {
  auto& [shift_m, turn_rad, spin_rad] = v;
  pass_all(s, shift_m, turn_rad, spin_rad);
}
template <class S>
void pass(S& s, arm::VehicleShape::Box& v) {
  auto& [centre_m, size_m] = v;
  pass_all(s, centre_m, size_m);
}
template <class S>
void pass(S& s, arm::VehicleShape::Rod& v) {
  auto& [a_m, b_m, radius_m] = v;
  pass_all(s, a_m, b_m, radius_m);
}
template <class S>
void pass(S& s, arm::VehicleShape& v) {
  auto& [boxes, rods] = v;
  pass_all(s, boxes, rods);
}
template <class S>
void pass(S& s, mission::MissionConfig& v) {
  auto& [tasks, layout, docking, vehicle, park, lamps, always_on, camera_syncs, frames_per_background, image_due, sweep_speed, verify_band,
         move_speed, approach_distance, approach_speed, press_speed, press_overtravel, press_torque, turn_speed, valve_tolerance, tries] =
      v;
  pass_all(s, tasks, layout, docking, vehicle, park, lamps, always_on, camera_syncs, frames_per_background, image_due, sweep_speed,
           verify_band, move_speed, approach_distance, approach_speed, press_speed, press_overtravel, press_torque, turn_speed,
           valve_tolerance, tries);
}
template <class S>
void pass(S& s, safety::JointLimit& v) {
  auto& [min_rad, max_rad, speed, torque] = v;
  pass_all(s, min_rad, max_rad, speed, torque);
}
template <class S>
void pass(S& s, safety::Limits& v) {
  auto& [joints, low, high, stale_position, stale_image, vision_timeout, contact_torque, checksum] = v;
  pass_all(s, joints, low, high, stale_position, stale_image, vision_timeout, contact_torque, checksum);
}
template <class S>
void pass(S& s, arm::Friction& v) {
  auto& [coulomb, viscous, efficiency, back_efficiency, doubt, efficiency_doubt] = v;
  pass_all(s, coulomb, viscous, efficiency, back_efficiency, doubt, efficiency_doubt);
}
template <class S>
void pass(S& s, arm::TransmissionSetup& v) {
  auto& [counts_per_rev, friction] = v;
  pass_all(s, counts_per_rev, friction);
}
template <class S>
void pass(S& s, ArmActuator& v) {
  auto& [pivot_a, pivot_b, offset, counts_per_m, counts_per_rad] = v;
  pass_all(s, pivot_a, pivot_b, offset, counts_per_m, counts_per_rad);
}
template <class S>
void pass(S& s, ArmModel::Planar& v) {
  auto& [mount_yaw, a0, a1, a2, d, shoulder_offset, elbow_offset] = v;
  pass_all(s, mount_yaw, a0, a1, a2, d, shoulder_offset, elbow_offset);
}
template <class S>
void pass(S& s, ArmModel::Joint& v) {
  auto& [lower, upper, velocity, acceleration, effort, rated_torque, actuator, stiffness] = v;
  pass_all(s, lower, upper, velocity, acceleration, effort, rated_torque, actuator, stiffness);
}
template <class S>
void pass(S& s, ArmModel::Jaw& v) {
  auto& [pivot_x, pivot_z, face_x, face_z, pad_width, pad_depth, lower, upper] = v;
  pass_all(s, pivot_x, pivot_z, face_x, face_z, pad_width, pad_depth, lower, upper);
}
template <class S>
void pass(S& s, ArmModel::Capsule& v) {
  auto link = static_cast<std::uint32_t>(v.link());  // a size is of another width on the two
  Vec3 a_m = v.a_m(), b_m = v.b_m();
  double radius_m = v.radius_m() - ArmModel::Capsule::rounding_m;
  pass_all(s, link, a_m, b_m, radius_m);
  v = ArmModel::Capsule(link, a_m, b_m, radius_m);
}
template <class S>
void pass(S& s, ArmModel& v) {
  auto& [arm_joints, rolls, form, planar, tool_z_m, joints, origins, jaw, capsules] = v;
  auto number = static_cast<std::uint32_t>(arm_joints);
  pass_all(s, number, rolls, form, planar, tool_z_m);
  arm_joints = number;
  pass_first(s, joints, v.joint_count());
  pass_first(s, origins, v.joint_count() + 1);
  pass_all(s, jaw, capsules);
}
template <class S>
void pass(S& s, arm::Arm& v) {
  ArmModel model = v.model();
  pass(s, model);
  v = arm::Arm(model);
}
template <class S>
void pass(S& s, MissionSetup& v) {
  auto& [arm, transmissions, camera, laser, markers, mission, limits, mission_limits] = v;
  pass(s, arm);
  pass_first(s, transmissions, arm5e_joint::count);
  pass_all(s, camera, laser, markers, mission, limits, mission_limits);
}
template <class S>
void pass(S& s, ControllerConfig& v) {
  pass_all(s, static_cast<MissionSetup&>(v), v.network);
}

// What comes from the vision side.
template <class S>
void pass(S& s, StripeForm& v) {
  auto& [width, lens, scatter, skew, speckle, model_share] = v;
  pass_all(s, width, lens, scatter, skew, speckle, model_share);
}
template <class S>
void pass(S& s, ScanStats& v) {
  auto& [images, stripes, stills, unexpected, refused, missing, repeated, peaks, weak, saturated, ambiguous, unfitted, misfit, lone, points,
         overflowed, no_joints, commands, still, stripe, newest] = v;
  pass_all(s, images, stripes, stills, unexpected, refused, missing, repeated, peaks, weak, saturated, ambiguous, unfitted, misfit, lone,
           points, overflowed, no_joints, commands, still.mean_grey, still.contrast_grey, still.white_share, stripe, newest);
}
template <class S>
void pass(S& s, PlaneFit& v) {
  auto& [valid, plane, points, inliers, rms_m, bend_m, seen_m, shape_shift_m, depth_m_per_rad] = v;
  pass_all(s, valid, plane.normal, plane.offset_m, points, inliers, rms_m, bend_m, seen_m, shape_shift_m, depth_m_per_rad);
}
template <class S>
void pass(S& s, MarkerObservation& v) {
  auto& [id, corners, centre, pose, rms, ambiguity, margin] = v;
  pass_all(s, id, corners, centre, pose, rms, ambiguity, margin);
}
template <class S>
void pass(S& s, ProudCluster& v) {
  auto& [centroid, axis, length, width, height, height_max, points] = v;
  pass_all(s, centroid, axis, length, width, height, height_max, points);
}
template <class S>
void pass(S& s, PointerObservation& v) {
  auto& [seen, direction, confidence, still_evidence, cloud_evidence] = v;
  pass_all(s, seen, direction, confidence, still_evidence, cloud_evidence);
}
template <class S>
void pass(S& s, PanelResult& v) {
  auto& [id, measured, answered, fit, markers, clusters, dropped, pointers, confidence] = v;
  pass_all(s, id, measured, answered, fit, markers, clusters, dropped, pointers, confidence);
}

// What goes to it.
template <class S>
void pass(S& s, ScanCommand& v) {
  auto& [kind, joints, exposure_start, exposure_kind, trigger, sweep] = v;
  pass_all(s, kind, joints.t);
  pass_first(s, joints.q_rad, arm5e_joint::of_arm);
  pass_all(s, exposure_start, exposure_kind, trigger, sweep);
}

// One control period.
struct RecordedFrame {
  CanFrame frame;
  Time t;
};
struct RecordedTick {
  Time t;
  // In.
  StaticVector<RecordedFrame, 72> received;
  StaticVector<PanelResult, 1> panel;
  StaticVector<ScanStats, 16> stats;
  // Out.
  StaticVector<CanFrame, 64> sent;
  StaticVector<ScanCommand, 16> orders;
  mission::Step step = mission::Step::idle;
  std::uint32_t events = 0;
  std::uint8_t last = 0;  // nothing follows
};
template <class S>
void pass(S& s, RecordedFrame& v) {
  pass_all(s, v.frame, v.t);
}
template <class S>
void pass(S& s, RecordedTick& v) {
  auto& [t, received, panel, stats, sent, orders, step, events, last] = v;
  pass_all(s, t, received, panel, stats, sent, orders, step, events, last);
}

}  // namespace lf::test
