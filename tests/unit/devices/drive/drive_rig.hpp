// One drive on a scripted joint, driven by frames alone: SYNC every 4 ms, set-points by PDO, everything else by SDO.
#pragma once

#include <algorithm>
#include <cmath>

#include "host_sim/devices/drive/drive402.hpp"
#include "tests/unit/devices/canopen/client.hpp"

namespace lf::devices::test {

// Turns of the elbow's motor per turn of the joint, at 1 rad: by virtual work the motor has 1/974 of the joint's torque.
inline constexpr double ratio_at_start = 973.671;

// The elbow's screw, without friction. Its counts per radian run from 2,700 to 10,000 over the stroke.
inline DriveConfig elbow() {
  DriveConfig c;
  c.node = 3;
  c.actuator = {0.26, 0.06, 0.2115, 166667, 0};
  c.lower_rad = 0;
  c.upper_rad = 2.15294;
  c.peak_torque_nm = 90 / ratio_at_start;
  c.rated_torque_nm = 30 / ratio_at_start;
  c.max_velocity_rad_s = 0.35;
  c.max_acceleration_rad_s2 = 0.8;
  c.stiction_rad_s = 0.06;
  return c;
}

// A joint that does what it is told, but not past its stops.
struct ScriptedJoint {
  double q_rad = 1.0;
  double lower_rad = 0, upper_rad = 2.15294;
  double load_nm = 0;
  double moved_rad_s = 0;
  bool at_stop = false;
  double runs_off_rad_s = 0;  // whatever it is told

  void step(const JointDrive& drive) {
    double v = drive.released ? 0 : drive.velocity_rad_s;
    if (runs_off_rad_s != 0) v = runs_off_rad_s;
    const double next = q_rad + 1e-3 * v;
    at_stop = next <= lower_rad || next >= upper_rad;
    const double clamped = std::clamp(next, lower_rad, upper_rad);
    stop_torque_nm = at_stop && v != 0 ? std::copysign(drive.torque_limit_nm, v) : 0;
    moved_rad_s = (clamped - q_rad) / 1e-3;
    q_rad = clamped;
  }
  JointReading reading() const { return {q_rad, q_rad, moved_rad_s, load_nm + stop_torque_nm}; }
  double stop_torque_nm = 0;
};

class DriveRig {
 public:
  explicit DriveRig(const DriveConfig& config = elbow(), double q_rad = 1.0)
      : drive(config, Duration::from_ms(5), 7), client(drive.node()) {
    joint.q_rad = q_rad;
    drive.power_on(client.now, joint.reading());
    run_ms(10);
  }

  // Runs milliseconds; with `cyclic`, each fourth begins with the set-point PDO's SYNC. Keeps what the node sent in `sent`.
  void run_ms(int ms) {
    for (int i = 0; i < ms; ++i) step();
  }
  void step() {
    if (cyclic && tick_ % 4 == 0) {
      send_set_point();
      keep(client.sync());
    }
    ++tick_;
    client.now = client.now + Duration::from_ms(1);
    output = drive.tick(client.now, joint.reading());
    keep(client.take());
    joint.step(output);
  }

  // RPDO1 6040 607A 60B2 and TPDO1 6041 6064 6077, type 1; interpolation 4 ms; the other PDOs off; NMT start.
  void configure() {
    const std::uint8_t id = drive.node().id();
    client.map(0x1400, 0x200u + id, 1, {0x60400010, 0x607A0020, 0x60B20010});
    client.map(0x1800, 0x40000180u + id, 1, {0x60410010, 0x60640020, 0x60770010});
    for (std::uint16_t i = 1; i < 4; ++i) {
      client.write(static_cast<std::uint16_t>(0x1400 + i), 1, 0x80000000, 4);
      client.write(static_cast<std::uint16_t>(0x1800 + i), 1, 0xC0000000, 4);
    }
    client.write(0x60C2, 1, 4, 1);
    client.nmt(1);
    cyclic = true;
  }

  // Seeds the target and walks up to operation enabled in mode CSP.
  void enable(std::int8_t mode = 8) {
    configure();
    client.write(0x6060, 0, mode, 1);
    target = actual();
    for (const int word : {0x06, 0x07, 0x0F}) {
      controlword = static_cast<std::uint16_t>(word);
      run_ms(12);
    }
  }

  std::int32_t actual() { return static_cast<std::int32_t>(client.read(0x6064, 0)); }
  std::uint16_t status() { return static_cast<std::uint16_t>(client.read(0x6041, 0)); }

  void send_set_point() {
    const auto t = static_cast<std::uint32_t>(target);
    client.send(0x200u + drive.node().id(),
                {static_cast<std::uint8_t>(controlword & 0xFF), static_cast<std::uint8_t>(controlword >> 8), static_cast<std::uint8_t>(t),
                 static_cast<std::uint8_t>(t >> 8), static_cast<std::uint8_t>(t >> 16), static_cast<std::uint8_t>(t >> 24), 0, 0});
  }

  Drive402 drive;
  Client client;
  ScriptedJoint joint;
  JointDrive output;
  std::vector<CanFrame> sent;
  bool cyclic = false;
  std::uint16_t controlword = 0;
  std::int32_t target = 0;

 private:
  void keep(const std::vector<CanFrame>& frames) { sent.insert(sent.end(), frames.begin(), frames.end()); }
  std::int64_t tick_ = 0;
};

}  // namespace lf::devices::test
