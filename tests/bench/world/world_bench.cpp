#include "tests/bench/world/world_bench.hpp"

#include <time.h>

#include <algorithm>
#include <array>
#include <string>

#include "host_sim/world/world.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/scene/panel_scene.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::bench {
namespace {

using world::World;
using world::WorldConfig;

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

WorldConfig config_of(const ArmDescription& arm, const PerJoint<double>& start_rad) {
  WorldConfig config;
  config.arm = arm;
  config.scene = scene::make_scene(config.arm, config.layout);
  config.base_from_panel = config.layout.nominal_base_from_panel();
  config.start_rad = start_rad;
  return config;
}

// Simulated seconds a second, `seconds` long with constant drives; readings and poses are taken every step, as the simulator does.
double speed_of(World& of, const JointDrives& drives, double seconds) {
  double sum = 0;
  const double begin_s = thread_cpu_s();
  const double end_s = of.time_s() + seconds;
  while (of.time_s() < end_s) {
    of.set_drives(drives);
    of.step();
    sum += of.readings()[0].position_rad;
  }
  const double taken_s = thread_cpu_s() - begin_s;
  return sum == sum ? seconds / taken_s : 0;
}

JointDrives holding(double arm_nm) {
  JointDrives drives;
  for (JointDrive& drive : drives) drive = {0, arm_nm, false};
  return drives;
}

double free_speed(const ArmDescription& arm) {
  World of(config_of(arm, {0, 0.945, 2.095, 0, 0.3}));
  JointDrives drives = holding(80);
  drives[arm5e_joint::elbow].velocity_rad_s = -0.065;
  return speed_of(of, drives, 6.0);
}

double turning_speed(const ArmDescription& arm) {
  World of(config_of(arm, {0, 1.307, 1.151, 0.5 * pi, 0.1}));
  JointDrives drives = holding(40);
  drives[arm5e_joint::jaw] = {-0.4, 12, false};
  speed_of(of, drives, 0.6);
  drives[arm5e_joint::roll] = {-0.3, 12, false};
  return speed_of(of, drives, 3.0);
}

// The best of a few runs: others on the machine only ever slow one down.
template <typename Run>
Row row(const std::string& name, double aim, Run run) {
  double best = 0;
  for (int i = 0; i < 3; ++i) best = std::max(best, run());
  return {name, best, aim, "aim", best / aim, "x real time", "1 kHz, one core, thread CPU time, best of 3; ratio is ours / aim"};
}

}  // namespace

std::vector<Row> run_world_bench() {
  const ArmDescription arm = load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf");
  return {row("world_free", 60, [&] { return free_speed(arm); }), row("world_turning", 15, [&] { return turning_speed(arm); })};
}

}  // namespace lf::bench
