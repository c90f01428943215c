// The mission's own scene for the optics tests: robot, panel, camera, laser and lamps near their nominal places.
#pragma once

#include <random>

#include "host_sim/optics/optics.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/scene/panel_scene.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/optics/optics_scenes.hpp"

namespace lf::optics::test {

struct MissionScene {
  MissionScene() : arm(load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf")), scene(scene::make_scene(arm, layout)) {}

  // Joint angles (slew, shoulder, elbow, roll, jaw), the handle's angle, how far the left button is pressed.
  scene::BodyPoses poses(const PerJoint<double>& q, double handle_rad, double pressed_m) const {
    const auto turned = [](const ArmJoint& joint, double angle_rad) -> Pose {
      return joint.parent_from_joint * Eigen::AngleAxisd(angle_rad, joint.axis);
    };
    scene::BodyPoses poses = resting();
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) poses[i + 1] = poses[i] * turned(arm.joints[i], q[i]);
    poses[arm5e_body::finger_b] = poses[arm5e_body::wrist] * turned(arm.finger_b, q[4]);
    const Pose panel = layout.nominal_base_from_panel();
    poses[arm5e_body::panel] = panel;
    poses[arm5e_body::first_feature] = panel * Eigen::AngleAxisd(handle_rad, Vec3::UnitZ());
    for (std::size_t i = 0; i < layout.buttons.size(); ++i) {
      const double z = i == 0 ? -pressed_m : 0.0;
      const Vec2& at_m = layout.buttons[i].at_m;
      poses[arm5e_body::first_feature + 1 + i] = panel * Eigen::Translation3d(at_m.x(), at_m.y(), z);
    }
    return poses;
  }

  // An arm anywhere before the panel.
  scene::BodyPoses random_poses(std::mt19937& random) const {
    const auto within = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
    return poses({within(-0.3, 0.3), within(0.2, 1.3), within(0.8, 1.9), within(-1.5, 1.5), within(0.0, 0.5)}, within(-0.8, 0.8),
                 within(0.0, 0.008));
  }

  // A camera of half the mission's resolution, its laser, two lamps.
  OpticsConfig config() const {
    OpticsConfig config;
    config.scene = scene;
    config.water.particles_per_l = 3;
    CameraConfig camera;
    camera.intrinsics.width = 320, camera.intrinsics.height = 240;
    camera.intrinsics.fx = camera.intrinsics.fy = 180.8;
    camera.intrinsics.cx = 159.5, camera.intrinsics.cy = 119.5;
    camera.intrinsics.distortion = {-0.05, 0.02, 0.001, -0.001, 0};
    camera.base_from_camera = looking({0.015, -0.245, 0.060}, {0.678, 0.257, 0.688});
    config.cameras.push_back(camera);
    LaserConfig laser;
    laser.body_from_laser = arm.joints[3].parent_from_joint * arm.wrist_from_tool * Eigen::Translation3d(-0.090, 0, -0.365);
    config.lasers.push_back(laser);
    for (const double side : {-0.62, 0.45}) {
      LampConfig lamp;
      lamp.body_from_lamp = looking({0.02, side, 0.02}, Vec3(0.44, 0.0, 0.60) - Vec3(0.02, side, 0.02));
      config.lamps.push_back(lamp);
    }
    return config;
  }

  ArmDescription arm;
  PanelLayout layout;
  scene::Scene scene;
};

}  // namespace lf::optics::test
