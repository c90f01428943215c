// Everything that the arm must not touch in one place: the panel as well as it is known, what is bolted to the vehicle, and the arm itself.
#pragma once

#include <cstdint>

#include "firmware/arm/collision.hpp"

namespace lf::arm {

// What bars a way.
enum class Barrier : std::uint8_t { none, panel, vehicle, itself };

// The jaw's angles during a motion, from one to the other and all between.
struct JawSweep {
  double low_rad = 0;
  double high_rad = 0;
};

// Distances between surfaces, m; infinite where there is nothing.
struct Distances {
  double panel_m = 0;
  double vehicle_m = 0;
  double itself_m = 0;
};

// The circumstances of one motion.
struct Room {
  Pose base_from_panel = Pose::Identity();
  PanelDoubt doubt;
  JawSweep jaw;
  PanelParts meant_for_fingers = 0;  // what the fingers are to touch, or may
};

class Surroundings {
 public:
  // All three are known by their place.
  Surroundings(const Arm& arm, const PanelLayout& layout, const VehicleShape& vehicle)
      : arm_(arm), layout_(layout), panel_(layout), vehicle_(vehicle) {}

  Surroundings(Arm&&, const PanelLayout&, const VehicleShape&) = delete;
  Surroundings(const Arm&, PanelLayout&&, const VehicleShape&) = delete;
  Surroundings(const Arm&, const PanelLayout&, VehicleShape&&) = delete;

  // All questions from now on are about this room.
  void enter(const Room& room);
  const Room& room() const { return room_; }
  const Arm& arm() const { return arm_; }

  // 1 us on a desktop.
  Distances distances(const JointVector& q_rad, double jaw_rad) const;

 private:
  const Arm& arm_;
  const PanelLayout& layout_;
  PanelShape panel_;  // grown by the room's doubt
  const VehicleShape& vehicle_;
  Room room_;
};

}  // namespace lf::arm
