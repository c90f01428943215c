#include "tests/bench/optics/optics_bench.hpp"

#include <algorithm>
#include <chrono>
#include <string>

#include "host_sim/optics/optics.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/scene/panel_scene.hpp"

namespace lf::bench {
namespace {

using scene::BodyId;

Pose looking(const Vec3& position, const Vec3& axis) {
  Pose pose = Pose::Identity();
  const Vec3 z = axis.normalized(), x = Vec3::UnitZ().cross(z).normalized();
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  pose.translation() = position;
  return pose;
}

Pose turned(const ArmJoint& joint, double angle_rad) { return joint.parent_from_joint * Eigen::AngleAxisd(angle_rad, joint.axis); }

// Mid-sweep: the stripe crosses the panel and the handle.
scene::BodyPoses sweep_poses(const ArmDescription& arm, const PanelLayout& layout) {
  scene::BodyPoses poses;
  poses.fill(Pose::Identity());
  const std::array<double, joint_count> q{0, 0.945, 1.40, 0, 0.3};
  for (std::size_t i = 0; i < joint_count; ++i) poses[i + 1] = poses[i] * turned(arm.joints[i], q[i]);
  poses[std::size_t(BodyId::finger_b)] = poses[std::size_t(BodyId::wrist)] * turned(arm.finger_b, q[4]);
  const Pose panel = layout.nominal_base_from_panel();
  poses[std::size_t(BodyId::panel)] = panel;
  poses[std::size_t(BodyId::handle)] = panel * Eigen::AngleAxisd(0.3, Vec3::UnitZ());
  for (std::size_t i = 0; i < PanelLayout::button_count; ++i) {
    poses[std::size_t(BodyId::button_left) + i] = panel * Eigen::Translation3d(layout.buttons_m[i].x(), layout.buttons_m[i].y(), 0);
  }
  return poses;
}

optics::OpticsConfig reference_optics(const ArmDescription& arm, const PanelLayout& layout) {
  optics::OpticsConfig config;
  config.scene = scene::make_scene(arm, layout);
  optics::CameraConfig camera;
  camera.base_from_camera = looking({0.015, -0.245, 0.060}, {0.678, 0.257, 0.688});
  config.cameras.push_back(camera);
  optics::LaserConfig laser;
  laser.body_from_laser = arm.joints[3].parent_from_joint * arm.wrist_from_tool * Eigen::Translation3d(-0.090, 0, -0.365);
  config.lasers.push_back(laser);
  optics::LampConfig lamp;
  lamp.body_from_lamp = looking({0.0, 0.30, 0.03}, {0.70, -0.25, 0.66});
  config.lamps.push_back(lamp);
  return config;
}

double median_ms(optics::Optics& optics, const optics::Shot& shot) {
  optics::Frame frame;
  optics.render(shot, frame);
  std::vector<double> times;
  for (int i = 0; i < 15; ++i) {
    const auto start = std::chrono::steady_clock::now();
    optics.render(shot, frame);
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(times.begin(), times.begin() + 7, times.end());
  return times[7];
}

}  // namespace

std::vector<Row> run_optics_bench() {
  const ArmDescription arm = load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf");
  const PanelLayout layout;
  optics::OpticsConfig config = reference_optics(arm, layout);
  optics::Shot shot;
  shot.poses = sweep_poses(arm, layout);
  struct Case {
    const char* name;
    int threads;
    bool edges, lamps;
  };
  std::vector<Row> rows;
  for (const Case& c :
       {Case{"camera frame, 2 threads", 2, true, false}, Case{"camera frame, 1 thread", 1, true, false},
        Case{"camera frame, 2 threads, no edge samples", 2, false, false}, Case{"camera frame, 2 threads, lamps on", 2, true, true}}) {
    config.threads = c.threads;
    config.edge_sampling = c.edges;
    optics::Optics optics(config);
    shot.lamps = c.lamps;
    Row row;
    row.name = c.name;
    row.ours = median_ms(optics, shot);
    row.peer = 20;
    row.peer_name = "aim";
    row.ratio = row.peer / row.ours;
    row.unit = "ms";
    row.note = "640x480, laser on, mid-sweep";
    rows.push_back(row);
  }
  return rows;
}

}  // namespace lf::bench
