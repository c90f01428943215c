#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/world/arm_body.hpp"
#include "host_sim/world/bullet_world.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/world/world_fixture.hpp"

namespace lf::world {
namespace {

constexpr double step_s = 0.001;
constexpr std::size_t shoulder = 1, elbow = 2, roll = 3, jaw = 4;

// The arm alone.
struct Bench {
  WorldConfig config;
  BulletWorld world{30, 0, scene::bare_scene()};
  ArmBody arm;

  explicit Bench(const WorldConfig& of)
      : config(of), arm(of.arm, of.scene, {of.start_rad, of.joint_drag_nm_s, of.drive_stiffness_nm_rad, of.step_s, of.drag_coefficient}) {
    arm.part().enter(world.get());
  }
  ~Bench() { arm.part().leave(world.get()); }

  void run(double seconds, const JointDrives& drives) {
    arm.set_drives(drives);
    for (int i = 0; i < std::lround(seconds / config.step_s); ++i) {
      arm.before_step();
      world.step(config.step_s);
      arm.after_step();
    }
  }
  const JointReading& reading(std::size_t joint) const { return arm.readings()[joint]; }
};

JointDrives hold(double torque_nm = 200) {
  JointDrives drives;
  for (JointDrive& drive : drives) drive = {0, torque_nm, false};
  return drives;
}

WorldConfig weightless() {
  WorldConfig config = nominal_config();
  for (ArmLink& link : config.arm.links) link.wet_weight_n = 0;
  config.joint_drag_nm_s = 0;
  config.drag_coefficient = 0;
  return config;
}

WorldConfig frictionless(const Targets& start_rad) {
  WorldConfig config = nominal_config();
  for (ArmLink& link : config.arm.links) link.wet_weight_n = 9.81 * link.mass_kg;
  for (ArmJoint& joint : config.arm.joints) joint.holding_torque_nm = 0;
  config.joint_drag_nm_s = 0;
  config.drag_coefficient = 0;
  config.start_rad = start_rad;
  return config;
}

double potential_energy_j(const Bench& bench) {
  double energy = 0;
  for (std::size_t i = 1; i < arm5e_joint::links; ++i) {
    const ArmLink& link = bench.config.arm.links[i];
    energy -= link.wet_weight_n * (bench.arm.base_from_link(i) * link.link_from_com.translation()).z();
  }
  return energy;
}

// Forward kinematics written out from the description.
std::array<Pose, arm5e_joint::links> poses_of(const ArmDescription& arm, const Targets& q) {
  std::array<Pose, arm5e_joint::links> poses;
  poses[0] = Pose::Identity();
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    poses[i + 1] = poses[i] * arm.joints[i].parent_from_joint * Eigen::AngleAxisd(q[i], arm.joints[i].axis);
  }
  poses[6] = poses[4] * arm.finger_b.parent_from_joint * Eigen::AngleAxisd(q[jaw], arm.finger_b.axis);
  return poses;
}

TEST(ArmBody, linksStandWhereTheDescriptionPutsThem) {
  for (const Targets& q : {Targets{0, 0.6, 1.9, 0, 0.3}, Targets{-0.5, 1.2, 0.7, 2.0, 1.0}, Targets{0.3, 0.1, 0.2, -1.5, 0}}) {
    WorldConfig config = weightless();
    config.start_rad = q;
    const Bench bench(config);
    const auto expected = poses_of(config.arm, q);
    for (std::size_t i = 0; i < arm5e_joint::links; ++i) {
      EXPECT_TRUE(bench.arm.base_from_link(i).isApprox(expected[i], 1e-9)) << "link " << i;
    }
    EXPECT_TRUE(bench.arm.base_from_tool().isApprox(expected[4] * config.arm.wrist_from_tool, 1e-9));
  }
}

TEST(ArmBody, freeFallKeepsItsEnergy) {
  WorldConfig config = frictionless({-0.3, 0.5, 1.2, 0.5, 0.6});
  config.step_s = 0.0002;
  Bench bench(config);
  const double before_j = potential_energy_j(bench);
  EXPECT_NEAR(bench.arm.kinetic_energy_j(), 0, 1e-12);
  JointDrives free;
  for (JointDrive& drive : free) drive.released = true;
  bench.run(0.14, free);  // before the elbow meets its stop
  const double kinetic_j = bench.arm.kinetic_energy_j();
  EXPECT_GT(kinetic_j, 0.5);
  EXPECT_NEAR(kinetic_j + potential_energy_j(bench), before_j, 0.01 * kinetic_j);
}

// Accelerations from rest against Lagrange's equations with the mass matrix and the gravity from finite differences of the forward kinematics.
TEST(ArmBody, acceleratesFromRestAsLagrangesEquationsSay) {
  const Targets q{0.2, 0.7, 1.1, 0.4, 0.5};
  WorldConfig config = frictionless(q);
  config.drive_stiffness_nm_rad = {};  // rigid: the fingers move as one
  constexpr double h = 1e-6;
  Eigen::Matrix<double, 5, 5> mass = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> force = Eigen::Matrix<double, 5, 1>::Zero();
  const auto at = poses_of(config.arm, q);
  for (std::size_t link = 1; link < arm5e_joint::links; ++link) {
    const ArmLink& body = config.arm.links[link];
    Eigen::Matrix<double, 6, 5> jacobian;
    for (int j = 0; j < 5; ++j) {
      Targets up = q;
      up[std::size_t(j)] += h;
      const Pose moved = poses_of(config.arm, up)[link];
      const Eigen::AngleAxisd turn(Mat3(moved.linear() * at[link].linear().transpose()));
      jacobian.col(j).head<3>() = (moved * body.link_from_com.translation() - at[link] * body.link_from_com.translation()) / h;
      jacobian.col(j).tail<3>() = turn.axis() * turn.angle() / h;
    }
    const Mat3 com_axes = at[link].linear() * body.link_from_com.linear();
    const Mat3 inertia = com_axes * body.inertia_kg_m2 * com_axes.transpose();
    mass += body.mass_kg * jacobian.topRows<3>().transpose() * jacobian.topRows<3>();
    mass += jacobian.bottomRows<3>().transpose() * inertia * jacobian.bottomRows<3>();
    force += jacobian.topRows<3>().transpose() * Vec3(0, 0, body.wet_weight_n);
  }
  const Eigen::Matrix<double, 5, 1> expected = mass.ldlt().solve(force);

  Bench bench(config);
  JointDrives free;
  for (JointDrive& drive : free) drive.released = true;
  bench.run(step_s, free);
  for (int j = 0; j < 5; ++j) {
    EXPECT_NEAR(bench.reading(std::size_t(j)).velocity_rad_s / step_s, expected[j], 2e-3 * expected.norm()) << "joint " << j;
  }
}

TEST(ArmBody, driveReachesItsSpeedAndItsMotorRunsAhead) {
  WorldConfig config = weightless();
  config.joint_drag_nm_s = 0.5;
  Bench bench(config);
  JointDrives drives = hold();
  drives[elbow].velocity_rad_s = -0.2;
  bench.run(1.0, drives);
  EXPECT_NEAR(bench.reading(elbow).velocity_rad_s, -0.2, 1e-4);
  EXPECT_NEAR(bench.reading(elbow).motor_position_rad, bench.config.start_rad[elbow] - 0.2, 1e-9);
  EXPECT_NEAR(bench.reading(elbow).position_rad - bench.reading(elbow).motor_position_rad,
              0.5 * config.arm.joints[elbow].backlash_rad + 0.5 * 0.2 / config.drive_stiffness_nm_rad[elbow],
              1e-5);  // play, and what the drag winds up
}

// A finger weighs little: drag taken from the step before would throw it to and fro.
TEST(ArmBody, drivesGiveTheDragOfAnyCoefficientAndStandAfterIt) {
  for (const double drag_nm_s : {0.5, 2.0, 5.0}) {
    WorldConfig config = weightless();
    config.joint_drag_nm_s = drag_nm_s;
    config.start_rad = {0, 0.8, 1.0, 0, 0.5};
    Bench bench(config);
    JointDrives drives = hold();
    drives[roll].velocity_rad_s = drives[jaw].velocity_rad_s = 0.2;
    bench.run(1.0, drives);
    EXPECT_NEAR(bench.reading(roll).torque_nm, 0.2 * drag_nm_s, 0.002 * drag_nm_s) << drag_nm_s;
    EXPECT_NEAR(bench.reading(jaw).torque_nm, 0.2 * 0.1 * drag_nm_s, 0.002 * drag_nm_s) << "of each finger, at " << drag_nm_s;
    for (JointDrive& drive : drives) drive.released = true;
    bench.run(0.5, drives);
    for (std::size_t joint = 0; joint < arm5e_joint::count; ++joint)
      EXPECT_LT(std::abs(bench.reading(joint).velocity_rad_s), 1e-3) << joint;
  }
}

// At a steady speed the slew's drive gives what the water takes. The test sums the drag of each link's shapes over 2,000 strips of its own.
TEST(ArmBody, aSteadySlewTakesTheTorqueOfTheWatersDrag) {
  WorldConfig config = weightless();
  config.drag_coefficient = 1.1;
  config.start_rad = {0, 1.2, 0.3, 0, 0};
  for (const double speed_rad_s : {0.2, 0.4}) {
    Bench bench(config);
    JointDrives drives = hold();
    drives[0].velocity_rad_s = speed_rad_s;
    bench.run(1.0, drives);
    double expected_nm = 0;
    const Pose slew = bench.arm.base_from_link(1);
    const Vec3 axis = slew.linear() * config.arm.joints[0].axis;
    for (std::size_t link = 1; link < arm5e_joint::links; ++link) {
      for (const scene::Shape& shape : config.arm.links[link].shapes) {
        if (!shape.collides || shape.kind == scene::ShapeKind::mesh || shape.kind == scene::ShapeKind::sphere) continue;
        const bool box = shape.kind == scene::ShapeKind::box;
        int longest = 2;
        if (box) shape.size_m.maxCoeff(&longest);
        const double length_m = shape.size_m[longest] + (shape.kind == scene::ShapeKind::capsule ? 2 * shape.size_m.x() : 0);
        const double wide_m = box ? (shape.size_m.sum() - shape.size_m[longest]) / 2 : 2 * shape.size_m.x();
        const Pose pose = bench.arm.base_from_link(link) * shape.body_from_shape;
        constexpr int strips = 2000;
        for (int i = 0; i < strips; ++i) {
          const Vec3 place = pose * Vec3(Vec3::Unit(longest) * ((i + 0.5) / strips - 0.5) * length_m) - slew.translation();
          const Vec3 along = pose.linear().col(longest);
          const Vec3 velocity = speed_rad_s * axis.cross(place);
          const Vec3 across = velocity - along * along.dot(velocity);
          const Vec3 force = 0.5 * 1025 * 1.1 * wide_m * length_m / strips * across.norm() * across;
          expected_nm += axis.dot(place.cross(force));
        }
      }
    }
    ASSERT_GT(expected_nm, 0.01);
    EXPECT_NEAR(bench.reading(0).torque_nm, expected_nm, 0.03 * expected_nm) << speed_rad_s;
  }
}

TEST(ArmBody, motorCrossesThePlayBeforeTheJointMovesBack) {
  WorldConfig config = weightless();
  config.arm.joints[roll].backlash_rad = 0.02;
  config.joint_drag_nm_s = 0.5;
  Bench bench(config);
  JointDrives drives = hold();
  drives[roll].velocity_rad_s = 0.5;
  bench.run(0.2, drives);
  const double turned_rad = bench.reading(roll).position_rad;
  EXPECT_NEAR(bench.reading(roll).motor_position_rad - turned_rad, 0.01, 1e-3);
  drives[roll].velocity_rad_s = -0.5;
  bench.run(0.030, drives);                                         // 15 mrad back, less than the play of 20
  EXPECT_NEAR(bench.reading(roll).position_rad, turned_rad, 2e-3);  // coasts until the water stops it
  bench.run(0.2, drives);
  EXPECT_NEAR(bench.reading(roll).position_rad - bench.reading(roll).motor_position_rad, 0.01, 1e-3);
}

TEST(ArmBody, torqueReadingIsTheWeightThatTheDriveHolds) {
  WorldConfig config = nominal_config();
  config.start_rad = {0, 0.8, 1.0, 0, 0.3};
  Bench bench(config);
  bench.run(1.0, hold());
  for (const std::size_t joint : {shoulder, elbow}) {
    double expected_nm = 0;  // about the joint's axis, from what hangs on it
    const Pose origin = bench.arm.base_from_link(joint + 1);
    const Vec3 axis = origin.linear() * config.arm.joints[joint].axis;
    for (std::size_t link = joint + 1; link < arm5e_joint::links; ++link) {
      const Vec3 com = bench.arm.base_from_link(link) * config.arm.links[link].link_from_com.translation();
      expected_nm -= axis.dot((com - origin.translation()).cross(Vec3(0, 0, config.arm.links[link].wet_weight_n)));
    }
    EXPECT_NEAR(bench.reading(joint).torque_nm, expected_nm, 0.01 * std::abs(expected_nm) + 1e-3) << "joint " << joint;
    const double sag_rad = bench.reading(joint).position_rad - config.start_rad[joint];
    EXPECT_NEAR(
        sag_rad,
        -expected_nm / config.drive_stiffness_nm_rad[joint] - std::copysign(0.5 * config.arm.joints[joint].backlash_rad, expected_nm),
        1e-5);
  }
}

TEST(ArmBody, jawClosesOnItselfAndStallsAtItsTorqueLimit) {
  Bench bench(weightless());
  JointDrives drives = hold();
  drives[jaw] = {-0.3, 6.0, false};
  bench.run(3.0, drives);
  EXPECT_NEAR(bench.reading(jaw).position_rad, -0.057, 2e-3);  // the pads' far edges meet just before the stop at -0.058
  EXPECT_NEAR(bench.reading(jaw).torque_nm, -6.0, 1e-6);
}

TEST(ArmBody, releasedDriveHoldsUpToItsGearsFriction) {
  for (const double holding_nm : {0.5, 10.0}) {
    WorldConfig config = nominal_config();
    config.start_rad = {0, 0.8, 1.0, 0, 0.3};
    for (ArmJoint& joint : config.arm.joints) joint.holding_torque_nm = holding_nm;
    Bench bench(config);
    JointDrives released;
    for (JointDrive& drive : released) drive.released = true;
    bench.run(1.0, released);
    const double moved_rad = std::abs(bench.reading(elbow).position_rad - config.start_rad[elbow]);
    if (holding_nm < 1) {
      EXPECT_GT(moved_rad, 0.05);  // the elbow carries about 1.2 N m
    } else {
      EXPECT_LT(moved_rad, 0.001);
    }
  }
}

TEST(ArmBody, commandThatIsNotANumberGivesNoTorque) {
  Bench bench(weightless());
  JointDrives drives = hold();
  drives[elbow].velocity_rad_s = std::nan("");
  bench.run(0.1, drives);
  EXPECT_EQ(bench.reading(elbow).torque_nm, 0);
  EXPECT_TRUE(std::isfinite(bench.reading(elbow).position_rad));
}

// The arm's weight on the shoulder, N m, and how far a drive of these shares of it comes in half a second, positive against the load.
struct Lifting {
  double load_nm = 0, way_rad = 0, torque_nm = 0;
};
Lifting lift(double speed_rad_s, double push_share, double hold_share) {
  WorldConfig config = nominal_config();
  for (ArmLink& link : config.arm.links) link.wet_weight_n = 9.81 * link.mass_kg;
  Bench bench(config);
  bench.run(1, hold());
  Lifting lifting;
  lifting.load_nm = bench.reading(shoulder).torque_nm;
  const double up = std::copysign(1.0, lifting.load_nm), load_nm = std::abs(lifting.load_nm),
               before_rad = bench.reading(shoulder).position_rad;
  JointDrives drives = hold();
  drives[shoulder] = {up * speed_rad_s, push_share * load_nm, false, hold_share * load_nm};
  bench.run(0.5, drives);
  lifting.way_rad = up * (bench.reading(shoulder).position_rad - before_rad);
  lifting.torque_nm = bench.reading(shoulder).torque_nm;
  return lifting;
}

// Friction helps a gear that is pushed back: between the torque that it pushes with and the torque that it holds, it stalls, whichever way it tries.
TEST(ArmBody, AGearHoldsMoreThanItPushes) {
  constexpr double speed_rad_s = 0.02, way_rad = 0.5 * speed_rad_s;
  const double load_nm = lift(0, 2, 2).load_nm;
  ASSERT_GT(std::abs(load_nm), 10);
  EXPECT_NEAR(lift(speed_rad_s, 1.5, 2).way_rad, way_rad, 0.003) << "it lifts what it can push";
  for (const double asked_rad_s : {0.0, speed_rad_s}) {
    SCOPED_TRACE(asked_rad_s);
    const Lifting stalled = lift(asked_rad_s, 0.5, 1.5);
    EXPECT_NEAR(stalled.way_rad, 0, 0.003);
    EXPECT_NEAR(stalled.torque_nm, load_nm, 0.05 * std::abs(load_nm));
    EXPECT_LT(lift(asked_rad_s, 0.5, 0.5).way_rad, -0.05) << "what it does not hold falls";
  }
  EXPECT_NEAR(lift(-speed_rad_s, 0.5, 1.5).way_rad, -way_rad, 0.006) << "it lets down at its own speed";
}

}  // namespace
}  // namespace lf::world
