#include "tests/unit/drives/drive_bench.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/arm/actuator.hpp"
#include "hal/config/boot_sentence.hpp"
#include "hal/config/drive_kind.hpp"
#include "hal/config/share.hpp"
#include "host_sim/devices/drive/drive_dictionary.hpp"
#include "shared/arm/arm_description.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::test {
namespace {

constexpr std::size_t elbow_index = arm5e_joint::elbow;

ArmDescription arm() { return load_arm_urdf((config::share_folder() / "arm" / "arm5e.urdf").string()); }

canopen::NetworkConfig network_config(const Make& make) {
  config::Machine machine;
  machine.file = "bench";
  machine.homing_file = "homing/simulator.yaml";
  config::JointDriveChoice& choice = machine.drives.joints[elbow_index];
  machine.drives.rated_current_a = 1.333;
  choice.profile = make.profile.empty() ? make.dictionary : make.profile;
  choice.polarity = make.reversed ? "reversed" : "forward";
  return config::make_core(machine).controller.network;
}

devices::DevicesConfig bench_devices(const Make& make) {
  devices::DevicesConfig config = devices::devices_config(arm(), {}, 7);
  devices::DriveConfig& drive = config.drives[elbow_index];
  drive.habit = devices::find_habit(make.dictionary);
  if (drive.habit != nullptr)
    drive.dictionary = devices::read_dictionary(config::share_folder() / "drives" / "objects.csv", drive.habit->dictionary);
  drive.switches = make.switches;
  drive.reversed = make.reversed;
  return config;
}

}  // namespace

DriveBench::DriveBench(const Make& make, const std::function<void(canopen::NetworkConfig&, devices::DevicesConfig&)>& change)
    : config(network_config(make)),
      devices_config([&] {
        devices::DevicesConfig all = bench_devices(make);
        if (change) change(config, all);
        return all;
      }()),
      network(config),
      devices(devices_config) {
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    const double middle = 0.5 * (devices_config.drives[i].lower_rad + devices_config.drives[i].upper_rad);
    joints[i].position_rad = joints[i].motor_position_rad = middle;
  }
}

void DriveBench::step() {
  ++ms_;
  now = Time::from_ns(std::int64_t{ms_} * 1'000'000);
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    const JointDrive drive = devices.drives()[i];
    JointReading& joint = joints[i];
    const double lower = devices_config.drives[i].lower_rad, upper = devices_config.drives[i].upper_rad;
    const double wanted = joint.position_rad + drive.velocity_rad_s * 1e-3;
    const double there = std::clamp(wanted, lower, upper);
    joint.velocity_rad_s = drive.velocity_rad_s;
    joint.torque_nm = there != wanted ? std::copysign(drive.torque_limit_nm, drive.velocity_rad_s) : 0;
    if (i == elbow_index) joint.torque_nm += load_nm;
    joint.position_rad = joint.motor_position_rad = there;
    powered_before_done = powered_before_done || (network.boot().state != canopen::BootState::done && !drive.released);
  }
  devices.step(now, joints);
  CanFrame frame;
  Time delivered;
  while (devices.next_to_master(frame, delivered)) {
    if (master_alive) network.on_frame(frame, delivered);
  }
  if (ms_ % 4 != 0 || !master_alive) return;
  canopen::Outbox outbox;
  network.tick(now, outbox);
  for (const CanFrame& sent : outbox) {
    const bool keeps_alive = (sent.id & 0x780u) == 0x700u;
    if (orders_arrive || keeps_alive) devices.master_sends(sent, now);
  }
}

void DriveBench::run(Duration time) {
  for (const Time end = now + time; now < end;) step();
}

bool DriveBench::run_until(const std::function<bool()>& done, Duration limit) {
  for (const Time end = now + limit; now < end;) {
    if (done()) return true;
    step();
  }
  return done();
}

bool DriveBench::boot() {
  run(Duration::from_ms(200));  // power, and the drives' own boot-up
  powered_before_done = false;
  network.start_boot(now);
  run_until([this] { return network.boot().state != canopen::BootState::running; }, Duration::from_s(20));
  return network.boot().state == canopen::BootState::done;
}

std::string DriveBench::sentence() const { return config::boot_sentence(network.boot().nodes[elbow_index], "elbow"); }

double DriveBench::joint_counts() const {
  return arm::exact_counts_from_rad(test::arm5e.joint(arm5e_joint::elbow), joints[elbow_index].motor_position_rad);
}

}  // namespace lf::test
