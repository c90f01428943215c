// Everything the core is told before it starts: one plain struct, checked by the hosted side, and again by the core where safety hangs on it.
#pragma once

#include "firmware/arm/transmission.hpp"
#include "firmware/canopen/network.hpp"
#include "firmware/mission/mission_config.hpp"
#include "firmware/safety/limits.hpp"
#include "firmware/scan/peaks.hpp"
#include "shared/calibration/calibration.hpp"

namespace lf {

// What the mission works with.
struct MissionSetup {
  arm::Arm arm = arm::arm5e();
  PerJoint<arm::TransmissionSetup> transmissions;  // between the drives' motors and the joints
  CameraCalibration camera;
  LaserCalibration laser;
  MarkerCalibrations markers;  // of the panel, no two with the same id
  mission::MissionConfig mission;
  safety::Limits limits;          // from the checksummed file
  safety::Limits mission_limits;  // equal or tighter; wider is refused
};

struct ControllerConfig : MissionSetup {
  canopen::NetworkConfig network;
};

}  // namespace lf
