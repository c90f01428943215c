// The simulator's drives and output node on a CAN interface, with joints that go where they are driven: no world, no camera, none of their libraries,
// so that an emulated processor can run it. What `lanternfish serve --camera none` does, but for the physics.
// Usage: nodes_on_can INTERFACE; ends at SIGTERM.
#include <csignal>
#include <cstdio>

#include "host_sim/serve/served_bus.hpp"
#include "host_sim/serve/socket_can_link.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/arm/make_model.hpp"
#include "tests/arm5e_joints.hpp"

namespace {

volatile std::sig_atomic_t stopped = 0;

// Parked, as the simulated arm starts.
constexpr lf::PerJoint<double> start_rad{0, 0.60, 1.90, 0, 0.3};

void follow(lf::JointReading& joint, const lf::JointDrive& drive) {
  joint.velocity_rad_s = drive.released ? 0 : drive.velocity_rad_s;
  joint.position_rad += joint.velocity_rad_s * lf::serve::Pace::step.s();
  joint.motor_position_rad = joint.position_rad;
}

int serve(const char* interface) {
  using namespace lf;
  serve::SocketCanLink link(interface);
  const ArmDescription arm = load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf");
  devices::NodeRack rack(devices::devices_config(arm, {}, 1), Time{});
  serve::ServedBus bus(rack, link, serve::NodeSet::all(), make_model(arm));
  JointReadings readings{};
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) readings[i].position_rad = readings[i].motor_position_rad = start_rad[i];
  serve::Pace pace(link.now());
  std::puts("serving nodes");
  std::fflush(stdout);
  while (stopped == 0) {
    while (link.wait(pace.due())) {
      if (!bus.receive(pace) || link.now() >= pace.due()) break;
    }
    const Time t = pace.begin(link.now());
    const JointDrives drives = bus.drives(readings);
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) follow(readings[i], drives[i]);
    bus.step(t, readings);
  }
  std::printf("%llu frames received, %llu sent, %llu calls failed; %llu of %llu steps over 1 ms late\n",
              static_cast<unsigned long long>(bus.stats().received), static_cast<unsigned long long>(bus.stats().sent),
              static_cast<unsigned long long>(bus.stats().send_failures), static_cast<unsigned long long>(pace.stats().late_1_ms),
              static_cast<unsigned long long>(pace.stats().steps));
  return bus.stats().send_failures == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::signal(SIGTERM, [](int) { stopped = 1; });
  try {
    return serve(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "nodes_on_can: %s\n", error.what());
    return 3;
  }
}
