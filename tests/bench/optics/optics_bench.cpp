#include "tests/bench/optics/optics_bench.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <string>

#include "host_sim/optics/formation/formation.hpp"
#include "host_sim/optics/optics.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/scene/panel_scene.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/arm5e_joints.hpp"

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

constexpr double particles_per_l = 3;

// Mid-sweep: the stripe crosses the panel and the handle.
scene::BodyPoses sweep_poses(const ArmDescription& arm, const PanelLayout& layout, double swept_rad = 0) {
  scene::BodyPoses poses = scene::poses_at_origin(scene::bare_scene());
  const PerJoint<double> q{0, 0.945 + swept_rad, 1.40, 0, 0.3};
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) poses[i + 1] = poses[i] * turned(arm.joints[i], q[i]);
  poses[arm5e_body::finger_b] = poses[arm5e_body::wrist] * turned(arm.finger_b, q[4]);
  const Pose panel = layout.nominal_base_from_panel();
  poses[arm5e_body::panel] = panel;
  std::size_t body = arm5e_body::first_feature;
  poses[body++] = panel * Eigen::AngleAxisd(0.3, Vec3::UnitZ());
  for (const PanelLayout::Button& button : layout.buttons)
    poses[body++] = panel * Eigen::Translation3d(button.at_m.x(), button.at_m.y(), 0);
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
  // Everything on. A default run has 0.1 to 3 specks a litre.
  config.water.particles_per_l = particles_per_l;
  return config;
}

double median_ms(const std::function<void()>& work) {
  work();
  std::vector<double> times;
  for (int i = 0; i < 15; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(times.begin(), times.begin() + 7, times.end());
  return times[7];
}

// What lies between the light of the scene and the picture, less the sensor's noise, which a picture without water and lens has as well.
Row formation_row(const optics::CameraConfig& config) {
  const optics::Camera camera(config);
  optics::Formation formation(camera);
  optics::WorkerPool pool(1);
  optics::PixelStore pixels;
  pixels.resize(camera.width(), camera.height(), camera.channels());
  const std::size_t packets_a_row = pixels.stride / lane_count;
  std::vector<std::uint8_t> lines(packets_a_row * static_cast<std::size_t>(camera.height()));
  const auto fill = [&] {
    for (int v = 0; v < camera.height(); ++v) {
      for (int u = 0; u < camera.width(); ++u) {
        // A stripe that falls by a fifth of its length.
        const float off = static_cast<float>(v) - 200 - 0.2f * static_cast<float>(u), light = std::exp(-0.2f * off * off);
        pixels.grey[pixels.index(u, v)] = 60;
        pixels.scattered[pixels.index(u, v)] = 20 + 30 * light;
        pixels.laser[pixels.index(u, v)] = 100 * light;
        if (light > 1e-4f) lines[static_cast<std::size_t>(v) * packets_a_row + static_cast<std::size_t>(u / lane_count)] = 1;
      }
    }
  };
  fill();
  std::vector<std::uint8_t> row(static_cast<std::size_t>(camera.width()) * camera.channels());
  const optics::Speckle speckle(0.15, 1, Vec3::Zero());
  const optics::Exposing exposing{1, 1, 7};
  const double whole_ms = median_ms([&] {
    formation.spread(pixels, lines, true, pool);
    for (int v = 0; v < camera.height(); ++v) formation.expose_row(pixels, v, speckle, exposing, row.data());
  });
  const double sensor_ms = median_ms([&] {
    for (int v = 0; v < camera.height(); ++v) camera.sensor.expose(pixels.grey.data() + pixels.index(0, v), v, exposing, row.data());
  });
  Row line;
  line.name = "of it water, lens and speckle, 1 thread";
  line.ours = whole_ms - sensor_ms;
  line.peer = 1;
  line.peer_name = "aim";
  line.ratio = line.peer / line.ours;
  line.unit = "ms";
  line.note = "on top of the sensor's noise";
  return line;
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
    double particles_per_l, asked_fps;
  };
  std::vector<Row> rows;
  for (const Case& c : {Case{"camera, one sample a pixel, 2 threads", 2, false, false, particles_per_l, 60},
                        Case{"camera, edge samples, 2 threads", 2, true, false, particles_per_l, 40},
                        Case{"camera, edge samples, lamps, 2 threads", 2, true, true, particles_per_l, 40},
                        Case{"camera, edge samples, 1 thread", 1, true, false, particles_per_l, 20},
                        Case{"camera, edge samples, 2 threads, no particles", 2, true, false, 0, 40}}) {
    config.threads = c.threads;
    config.edge_sampling = c.edges;
    config.water.particles_per_l = c.particles_per_l;
    optics::Optics optics(config);
    shot.lamps = c.lamps;
    shot.time_s = 0;
    Row row;
    row.name = c.name;
    optics::Frame frame;
    // As in a sweep: the stripe moves, the particles drift, and the noise is another one.
    constexpr double interval_s = 0.04, speed_rad_s = 0.01;
    row.ours = 1000 / median_ms([&] {
                 shot.time_s += interval_s;
                 ++shot.frame_number;
                 shot.poses = sweep_poses(arm, layout, speed_rad_s * shot.time_s);
                 optics.render(shot, frame);
               });
    row.peer = c.asked_fps;
    row.peer_name = "asked";
    row.ratio = row.ours / row.peer;
    row.unit = "frames/s";
    row.note = "640x480, laser on, mid-sweep";
    rows.push_back(row);
  }
  rows.push_back(formation_row(config.cameras.front()));
  return rows;
}

}  // namespace lf::bench
