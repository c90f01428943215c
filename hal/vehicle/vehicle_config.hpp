// vehicle.yaml: the machine (hal/config/machine.hpp, the same keys as a scenario's), and what it stands on: bus, camera, threads, operator, files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/config/machine.hpp"
#include "hal/vehicle/realtime.hpp"
#include "hal/vehicle/ring_camera.hpp"
#include "hal/vehicle/socket_can.hpp"
#include "hal/vehicle/v4l2_camera.hpp"

namespace lf::hal {

// Once it is loaded, paths are absolute: those that the file has are relative to its folder.
struct VehicleConfig {
  config::Machine machine;
  config::Camera machines_camera;  // as the machine's file has it, before the own keys
  std::string machine_file;        // what the robot is; empty: as the keys of its groups say
  // The panel's keys: what `machine.panel` is made of.
  std::string panel_file;
  config::DockedPanel docked_panel;
  config::ValveStops valve_stops;
  config::Core core;          // made of it, with the homing file's offsets
  bool homing_named = false;  // by the file's `homing.file`, which `machine` has only if it is there

  std::string interface = "can0";
  double transmit_deadline_ms = 4;  // a SYNC period

  std::string camera_source = "device";  // device, ring or none
  std::string device = "/dev/video0";
  std::int32_t gain = 0;
  std::int32_t stamp_delay_us = 0;
  std::string ring;
  std::int64_t ring_bytes = static_cast<std::int64_t>(frame_ring_bytes(camera_ring_slots, camera_ring_payload));
  std::int64_t ring_offset = 0;
  std::int32_t match_window_us = 2000;
  std::int32_t image_due_ms = 100;

  RealtimeConfig realtime;
  std::int32_t vision_cpu = -1;

  std::string operator_socket = "/run/lanternfishd/operator.sock";
  std::string operator_group;          // that may open the socket; empty: the daemon's own
  bool operator_everyone = false;      // every user of this machine may
  std::vector<std::string> operators;  // users or groups beside root and the daemon's own user
  std::vector<std::string> engineers;

  std::string estop_input;  // a file that reads 1 while the chain is whole: a GPIO's value; empty: none beside the output node's
  std::string log_folder = "/var/log/lanternfishd";
  std::int64_t log_file_mb = 256;  // half an hour of can0.log at 36 % load
  std::int32_t log_keep = 24;      // 13 h of it; packed they take some 0.6 GB
  bool log_pack = true;
  std::string lock_folder = "/run/lanternfishd";  // the service's RuntimeDirectory

  SocketCan::Config can() const;
  V4l2Camera::Config v4l2() const;
  RingCamera::Config ring_camera() const;
};

// In the order of the documentation. The pointers are into the argument.
config::Keys keys(VehicleConfig& config);

// Every key spelled out with its value, meaning, range and default, as YAML that load_vehicle_config reads back to the same. Empty `path`: the defaults;
// else what the file says, whether or not the files that it names are there. Throws InputError as load_vehicle_config does.
std::string print_vehicle_config(const std::string& path = "");

// JSON Schema of vehicle.yaml; shared/vehicle/vehicle.schema.json is its output.
std::string vehicle_schema();

// Throws InputError whose text has every problem on a line of its own, each with file and line where it has one.
VehicleConfig load_vehicle_config(const std::string& path);
// The same, but adds what is wrong to `problems`, as long as the file is YAML; what comes back is then good for looking at this machine alone.
VehicleConfig load_vehicle_config(const std::string& path, std::vector<std::string>& problems);

// Where a stop goes. Nothing but the file itself is read, and whatever is wrong there does not keep the stop back.
struct StopSocket {
  std::vector<std::string>
      paths;          // where the daemon may answer: a file that is reached by a link has two names, beside which a relative path may be
  bool told = false;  // by the file; false: the daemon's may be another one
  std::vector<std::string> problems;
};
StopSocket stop_socket(const std::string& path);

}  // namespace lf::hal
