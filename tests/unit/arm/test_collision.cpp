#include <gtest/gtest.h>

#include <cmath>

#include "firmware/arm/collision.hpp"
#include "firmware/arm/gripper.hpp"
#include "firmware/arm/inverse_kinematics.hpp"
#include "shared/arm/arm_description.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/arm/random_joints.hpp"

namespace lf::arm {
namespace {

constexpr std::uint64_t seed = 20136;

Capsule random_capsule(RandomJoints& random) {
  const auto point = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
  return {1, point(), point(), random.uniform(0.01, 0.1)};
}

// The smallest value of f on the capsule's axis, by brute force.
template <class Function>
double sampled(const Capsule& c, const Function& f) {
  double least = 1e9;
  for (int i = 0; i <= 4000; ++i) least = std::min(least, f(Vec3(c.a_m + (c.b_m - c.a_m) * (i / 4000.0))));
  return least - c.radius_m;
}

TEST(Clearance, OfCapsulesBoxesAndCylindersIsWhatSamplingFinds) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed);
  for (int k = 0; k < 200; ++k) {
    const Capsule a = random_capsule(random), b = random_capsule(random);
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(random.uniform(-3, 3), Vec3(1, random.uniform(-1, 1), 0.3).normalized()).toRotationMatrix();
    pose.translation() = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const Vec3 size(random.uniform(0.01, 0.5), random.uniform(0.01, 0.5), random.uniform(0.01, 0.5));
    const Pose inverse = pose.inverse();

    const auto to_segment = [&](const Vec3& p) {
      const Vec3 way = b.b_m - b.a_m;
      return (p - b.a_m - way * std::clamp(way.dot(p - b.a_m) / way.squaredNorm(), 0.0, 1.0)).norm();
    };
    ASSERT_NEAR(clearance_between(a, b), sampled(a, to_segment) - b.radius_m, 2e-3);
    ASSERT_LE(clearance_between(a, b), sampled(a, to_segment) - b.radius_m + 1e-12);
    ASSERT_NEAR(clearance_between(a, b), clearance_between(b, a), 1e-9);

    const auto to_box = [&](const Vec3& p) {
      const Vec3 q = inverse * p;
      return (q - q.cwiseMax(-size / 2).cwiseMin(size / 2)).norm();
    };
    ASSERT_NEAR(clearance_to_box(a, pose, size), sampled(a, to_box), 1e-3);
    ASSERT_LE(clearance_to_box(a, pose, size), sampled(a, to_box) + 1e-7);

    const auto to_cylinder = [&](const Vec3& p) {
      const Vec3 q = inverse * p;
      const double r = q.head<2>().norm();
      const Vec2 inward(std::min(r, size.x()), std::clamp(q.z(), -size.z() / 2, size.z() / 2));
      return (Vec2(r, q.z()) - inward).norm();
    };
    ASSERT_NEAR(clearance_to_cylinder(a, pose, size.x(), size.z()), sampled(a, to_cylinder), 1e-3);
    ASSERT_LE(clearance_to_cylinder(a, pose, size.x(), size.z()), sampled(a, to_cylinder) + 1e-7);

    const Plane plane{Vec3(1, 2, -2) / 3, 0.4};
    ASSERT_NEAR(clearance_to_plane(a, plane), sampled(a, [&](const Vec3& p) { return plane.signed_distance_m(p); }), 1e-12);
  }
}

TEST(LinkCapsules, ContainTheUrdfsCollisionShapes) {
  const ArmDescription arm = load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf");
  const LinkPoses links = test::arm5e.base_from_links(JointVector::Zero(), 0);
  const LinkCapsules capsules = test::arm5e.link_capsules(JointVector::Zero(), 0);
  for (std::size_t k = 1; k < arm5e_joint::links; ++k) {
    for (const scene::Shape& shape : arm.links[k].shapes) {
      if (!shape.collides) continue;
      const bool box = shape.kind == scene::ShapeKind::box;
      for (int i = 0; i < 64; ++i) {  // corners of the box, or the two rims of the cylinder
        const double angle = i * pi / 16, end = i % 2 == 0 ? 0.5 : -0.5;
        const Vec3 corner =
            box ? Vec3(((i >> 1 & 1) - 0.5) * shape.size_m.x(), ((i >> 2 & 1) - 0.5) * shape.size_m.y(), end * shape.size_m.z())
                : Vec3(shape.size_m.x() * std::cos(angle), shape.size_m.x() * std::sin(angle), end * shape.size_m.z());
        const Vec3 p = links[k - 1] * shape.body_from_shape * corner;
        bool inside = false;
        for (const Capsule& c : capsules) inside = inside || (c.link == k && clearance_between(c, {k, p, p, 0}) < 1e-9);
        ASSERT_TRUE(inside) << arm.links[k].name << ": " << corner.transpose();
      }
    }
  }
}

// The links that can meet, as the header lists them: forearm, wrist and fingers against the slew, wrist and fingers against the upper arm. Points along one
// capsule's axis are held against the other's.
TEST(ClearanceToItself, IsWhatSamplingFindsBetweenLinksThatAreNotNeighbours) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed);
  int near = 0, overlapping = 0;
  for (int k = 0; k < 300; ++k) {
    // Also where the joints' limits do not let the arm go: within them it never comes as near to itself as 50 mm.
    const JointVector q = planar_joints(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3));
    const LinkCapsules capsules = test::arm5e.link_capsules(q, random.uniform(0, 1));
    double least = 1e9;
    for (const Capsule& a : capsules) {
      for (const Capsule& b : capsules) {
        if (!((a.link == 1 && b.link >= 3) || (a.link == 2 && b.link >= 4))) continue;
        const auto to_axis = [&](const Vec3& p) {
          const Vec3 way = b.b_m - b.a_m;
          const double along = way.squaredNorm() > 0 ? std::clamp(way.dot(p - b.a_m) / way.squaredNorm(), 0.0, 1.0) : 0;
          return (p - b.a_m - way * along).norm();
        };
        least = std::min(least, sampled(a, to_axis) - b.radius_m);
      }
    }
    ASSERT_NEAR(clearance_to_itself(capsules), least, 2e-3) << q.transpose();
    near += least < 0.05 ? 1 : 0;
    overlapping += least < 0 ? 1 : 0;
  }
  EXPECT_GT(near, 20) << "poses near enough to matter";
  EXPECT_GT(overlapping, 5);
}

TEST(ClearanceToItself, IsPositiveInEveryPoseOfTheMission) {
  for (const JointVector& q : {planar_joints(0, 0.60, 1.90, 0), planar_joints(0, 1.307, 1.151, 1.5), planar_joints(0, 1.083, 1.355, 0),
                               planar_joints(0, 1.414, 1.425, 0), planar_joints(0.155, 1.423, 1.321, 0), planar_joints(0, 0.945, 2.095, 0),
                               planar_joints(0, 0.945, 0.920, 0)})
    for (const double gap : {0.0, 0.09})
      EXPECT_GT(clearance_to_itself(test::arm5e.link_capsules(q, jaw_from_gap(test::jaw5e, gap))), 0.02) << q.transpose();
}

TEST(PanelShape, NamesWhatIsNearest) {
  const PanelLayout layout;
  const Pose base_from_panel = layout.nominal_base_from_panel();
  const Clearance parked = PanelShape(layout).clearance(test::arm5e.link_capsules(planar_joints(0, 0.60, 1.90, 0), 0), base_from_panel);
  EXPECT_GT(parked.distance_m, 0.15);
  const Clearance grasp = PanelShape(layout).clearance(test::arm5e.link_capsules(planar_joints(0, 1.307, 1.151, 0), 0), base_from_panel);
  EXPECT_LT(grasp.distance_m, 0);
  EXPECT_EQ(grasp.part, PanelPart::valve(0));
  EXPECT_GE(grasp.link, 5u) << "a finger";
  const JointVector press = inverse_kinematics(test::arm5e, {0.395, 0, 0.407}, 0).q_rad;
  const Clearance button = PanelShape(layout).clearance(test::arm5e.link_capsules(press, jaw_from_gap(test::jaw5e, 0)), base_from_panel);
  EXPECT_EQ(button.part, PanelPart::button(1));
}

// The layout's promise: 20 mm between the closed tool and the handle at any angle while a button is pressed.
TEST(PanelShape, OfTheHandleIsTwentyMillimetresAtEveryButton) {
  const PanelLayout layout;
  const Pose base_from_panel = layout.nominal_base_from_panel();
  const double jaw_rad = jaw_from_gap(test::jaw5e, 0);
  for (std::size_t i = 0; i < layout.buttons.size(); ++i) {
    const Vec3 cap = base_from_panel * layout.buttons[i].face_m();
    const IkResult ik = inverse_kinematics(test::arm5e, cap - Vec3(tip_beyond_tool_m(test::jaw5e, jaw_rad), 0, 0), pi / 2, 0.02);
    ASSERT_TRUE(ik.ok()) << name(ik.outcome);
    PanelParts others = ~bit(PanelPart::valve(0));
    const Clearance handle = PanelShape(layout).clearance(test::arm5e.link_capsules(ik.q_rad, jaw_rad), base_from_panel, others);
    EXPECT_GT(handle.distance_m, 0.020) << "button " << i << ", link " << handle.link;
  }
}

// Points all over the solids of panels that are off by up to the doubt, each axis on its own, are inside of the grown ones: so whatever touches a point is
// nearer to the grown panel than nothing at all.
TEST(PanelShapeGrown, ContainsItselfWhereverItMayBe) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed);
  const PanelLayout layout;
  const PanelLayout::Valve& valve = layout.valves[0];
  const PanelLayout::Button& cap = layout.buttons[2];
  const PanelDoubt doubt{0.020, 0.0349, 0.0105};
  const Pose believed = layout.nominal_base_from_panel();
  const PanelShape surveyed(layout), grown = surveyed.grown(believed, doubt);
  double nearest_to_border = 1e9;
  for (int k = 0; k < 20'000; ++k) {
    const auto either = [&](double most) {
      return random.uniform(0, 1) < 0.5 ? std::copysign(most, random.uniform(-1, 1)) : random.uniform(-most, most);
    };
    Pose real = believed;
    real.translation() += Vec3(either(doubt.shift_m), either(doubt.shift_m), either(doubt.shift_m));
    real.linear() = Eigen::AngleAxisd(either(doubt.turn_rad), Vec3::UnitZ()).toRotationMatrix() *
                    Eigen::AngleAxisd(either(doubt.turn_rad), Vec3::UnitY()).toRotationMatrix() *
                    Eigen::AngleAxisd(either(doubt.turn_rad), Vec3::UnitX()).toRotationMatrix() * real.linear() *
                    Eigen::AngleAxisd(either(doubt.spin_rad), Vec3::UnitZ()).toRotationMatrix();
    // A corner or rim of the plate, a button's face, or the handle's disc.
    Vec3 p;
    const double angle = random.uniform(-pi, pi);
    switch (k % 3) {
      case 0:
        p = Vec3(either(1) < 0 ? layout.plate_min_m.x() : layout.plate_max_m.x(),
                 either(1) < 0 ? layout.plate_min_m.y() : layout.plate_max_m.y(), 0);
        break;
      case 1: p = Vec3(cap.at_m.x() + either(0.5 * cap.width_m), cap.at_m.y(), cap.height_m); break;
      default:
        p = Vec3(0, 0, valve.handle_height_m + either(0.5 * valve.handle_thickness_m)) +
            std::hypot(valve.handle_length_m, valve.handle_thickness_m) / 2 * Vec3(std::cos(angle), std::sin(angle), 0);
    }
    LinkCapsules all;
    all.push_back({2, real * p, real * p, 0});
    const double distance = grown.clearance(all, believed).distance_m;
    ASSERT_LE(distance, 1e-9) << "draw " << k << ", point " << p.transpose();
    // How much larger it could have been: the point's distance to the surveyed panel.
    nearest_to_border = std::min(nearest_to_border, std::abs(surveyed.clearance(all, believed).distance_m - 0.047));
  }
  EXPECT_LT(nearest_to_border, 0.005) << "no draw came near the worst: 20 mm, and 2 degrees over 0.78 m";
  EXPECT_NEAR(surveyed.grown(believed, {}).clearance(test::arm5e.link_capsules(planar_joints(0, 1.0, 1.5, 0), 0), believed).distance_m,
              surveyed.clearance(test::arm5e.link_capsules(planar_joints(0, 1.0, 1.5, 0), 0), believed).distance_m, 1e-12);
}

// A panel with two valves, four buttons and two markers, all apart.
PanelLayout two_valves() {
  PanelLayout layout;
  PanelLayout::Valve left, right;
  left.at_m = Vec2(-0.20, 0.02);
  right.at_m = Vec2(0.22, -0.15);
  right.handle_length_m = 0.14;
  right.handle_thickness_m = 0.016;
  right.handle_height_m = 0.08;
  layout.valves = decltype(layout.valves)(left, right);
  layout.buttons.clear();
  for (const double x_m : {-0.32, -0.11, 0.09, 0.31}) {
    PanelLayout::Button button;
    button.at_m = Vec2(x_m, 0.15);
    button.height_m = 0.03 + 0.05 * std::abs(x_m);
    (void)layout.buttons.push_back(button);
  }
  PanelLayout::Marker first, second;
  first.centre_m = Vec2(-0.30, -0.25);
  second.id = 8;
  second.centre_m = Vec2(0.02, -0.28);
  second.plate_m = 0.07;
  layout.markers = decltype(layout.markers)(first, second);
  return layout;
}

// The posts of a D-handle pass wherever its bar does, down to the plate. A flat bar comes nearer by half of what it is deeper.
TEST(PanelShape, OfAHandleIsWhatItsKindSweeps) {
  PanelLayout layout;
  layout.buttons.clear();
  layout.markers.clear();
  const auto to_a_ball = [&](const Vec3& at_m) {
    LinkCapsules ball;
    ball.push_back({4, at_m, at_m, 0.001});
    return PanelShape(layout).clearance(ball, Pose::Identity(), 0, 0).distance_m;
  };
  PanelLayout::Valve& valve = layout.valves[0];
  const Vec3 under_the_bar(0.040, 0, 0.050), before_it(0, 0, 0.150);
  const double beside_stem_m = to_a_ball(under_the_bar), before_bar_m = to_a_ball(before_it);
  EXPECT_GT(beside_stem_m, 0.030);
  valve.handle_depth_m = 0.030f;
  EXPECT_NEAR(before_bar_m - to_a_ball(before_it), (0.030 - valve.handle_thickness_m) / 2, 1e-8);
  valve.handle_depth_m = 0;
  valve.carried = PanelLayout::Carried::by_posts;
  EXPECT_LT(to_a_ball(under_the_bar), 0) << "a post comes by there";
  EXPECT_EQ(to_a_ball(before_it), before_bar_m);
}

TEST(PanelShape, NamesEachPartByItsKindAndIndex) {
  const PanelLayout layout = two_valves();
  Pose base_from_panel = layout.nominal_base_from_panel();
  base_from_panel.rotate(Eigen::AngleAxisd(0.4, Vec3(0.3, 1, -0.5).normalized()));
  const PanelShape panel(layout);
  constexpr double off_m = 0.004, thin_m = 0.001;
  // A thin capsule that ends so far off a place on the panel, and what is nearest to it.
  const auto near = [&](const Vec3& place_m, const Vec3& outward, PanelParts ignored = 0) {
    LinkCapsules all;
    all.push_back(
        {3, base_from_panel * Vec3(place_m + (off_m + thin_m) * outward), base_from_panel * Vec3(place_m + 0.02 * outward), thin_m});
    return panel.clearance(all, base_from_panel, ignored);
  };
  const auto expect_named = [&](PanelPart part, const Vec3& place_m, const Vec3& outward) {
    const Clearance nearest = near(place_m, outward);
    EXPECT_EQ(nearest.part, part) << int(nearest.part.kind) << " " << int(nearest.part.index);
    EXPECT_NEAR(nearest.distance_m, off_m, 1e-7);
    EXPECT_NE(near(place_m, outward, bit(part)).part, part);
    EXPECT_GT(near(place_m, outward, bit(part)).distance_m, off_m + 1e-4);
  };
  const Vec3 out = Vec3::UnitZ();
  for (std::size_t i = 0; i < layout.valves.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "valve " << i);
    const PanelLayout::Valve& valve = layout.valves[i];
    expect_named(PanelPart::valve(i), valve.handle_centre_m() + Vec3(0.02, 0.03, valve.handle_thickness_m / 2), out);
    expect_named(PanelPart::valve(i), valve.handle_centre_m() + Vec3(0, -valve.swept_radius_m(), 0), -Vec3::UnitY());
    const Vec3 stem = Vec3(valve.at_m.x() - valve.stem_radius_m, valve.at_m.y(), valve.handle_height_m / 2);
    expect_named(PanelPart::valve(i), stem, -Vec3::UnitX());
  }
  for (std::size_t i = 0; i < layout.buttons.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "button " << i);
    expect_named(PanelPart::button(i), layout.buttons[i].face_m(), out);
  }
  for (std::size_t i = 0; i < layout.markers.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "marker " << i);
    expect_named({PanelPart::Kind::marker_plate, static_cast<std::uint8_t>(i)}, layout.markers[i].panel_from_tag().translation(), out);
  }
  expect_named(PanelPart::plate(), Vec3(-0.05, -0.10, 0), out);
}

// The rims of handles and stems that stand off the panel's origin: what spins the panel moves them.
TEST(PanelShapeGrown, ContainsItsOffsetCylindersWhereverItMayBe) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed);
  const PanelLayout layout = two_valves();
  const PanelShape surveyed(layout);
  double farthest_m = 0;
  for (int k = 0; k < 20'000; ++k) {
    const auto either = [&](double most) {
      return random.uniform(0, 1) < 0.7 ? std::copysign(most, random.uniform(-1, 1)) : random.uniform(-most, most);
    };
    const auto turned = [&](double rad, const Vec3& axis) { return Eigen::AngleAxisd(rad, axis).toRotationMatrix(); };
    // The spin alone, all the rest alone, or both.
    const PanelDoubt doubt = k % 3 == 0   ? PanelDoubt{0, 0, 0.05}
                             : k % 3 == 1 ? PanelDoubt{0.010, 0.02, 0}
                                          : PanelDoubt{0.003, 0.004, 0.0105};
    Pose believed = layout.nominal_base_from_panel();
    believed.rotate(
        Eigen::AngleAxisd(random.uniform(-pi, pi), Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized()));
    Pose real = believed;
    real.translation() += Vec3(either(doubt.shift_m), either(doubt.shift_m), either(doubt.shift_m));
    real.linear() = turned(either(doubt.turn_rad), Vec3::UnitZ()) * turned(either(doubt.turn_rad), Vec3::UnitY()) *
                    turned(either(doubt.turn_rad), Vec3::UnitX()) * real.linear() * turned(either(doubt.spin_rad), Vec3::UnitZ());
    const std::size_t which = static_cast<std::size_t>(k / 3 % 2);
    const PanelLayout::Valve& valve = layout.valves[which];
    const double angle = random.uniform(-pi, pi), end = k / 6 % 2 == 0 ? 0.5 : -0.5;
    const Vec3 around(std::cos(angle), std::sin(angle), 0);
    const bool stem = k / 12 % 2 == 0;
    const Vec3 handle_rim = valve.handle_centre_m() + valve.swept_radius_m() * around + end * valve.handle_thickness_m * Vec3::UnitZ();
    const Vec3 stem_side = Vec3(valve.at_m.x(), valve.at_m.y(), random.uniform(0, valve.handle_height_m)) + valve.stem_radius_m * around;
    const Vec3 p = real * (stem ? stem_side : handle_rim);
    LinkCapsules all;
    all.push_back({2, p, p, 0});
    const PanelParts others = ~bit(PanelPart::valve(which));
    ASSERT_LE(surveyed.grown(believed, doubt).clearance(all, believed, others).distance_m, 1e-9) << "draw " << k;
    farthest_m = std::max(farthest_m, surveyed.clearance(all, believed, others).distance_m);
  }
  EXPECT_GT(farthest_m, 0.010) << "no draw moved a valve by what its place adds: 0.05 rad at 0.26 m";
}

TEST(PanelShape, LeavesOutForTheFingersWhatOnlyTheyMayTouch) {
  const PanelLayout layout;
  const Pose base_from_panel = layout.nominal_base_from_panel();
  const LinkCapsules grasp = test::arm5e.link_capsules(planar_joints(0, 1.307, 1.151, 0), 0);
  const PanelParts handle = bit(PanelPart::valve(0));
  const PanelShape panel(layout);
  EXPECT_LT(panel.clearance(grasp, base_from_panel).distance_m, 0);
  const Clearance others = panel.clearance(grasp, base_from_panel, 0, handle);
  EXPECT_GT(others.distance_m, 0.02);
  LinkCapsules without_fingers;
  for (const Capsule& capsule : grasp)
    if (capsule.link < 5) without_fingers.push_back(capsule);
  const double wrist_m = panel.clearance(without_fingers, base_from_panel).distance_m;
  const double fingers_m = panel.clearance(grasp, base_from_panel, handle).distance_m;
  EXPECT_NEAR(others.distance_m, std::min(wrist_m, fingers_m), 1e-12);
}

// The slew stands on the vehicle; everything after it counts.
TEST(ClearanceToTheVehicle, IsThatOfTheNearestSolidToAnyLinkButTheSlew) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed);
  for (int k = 0; k < 500; ++k) {
    VehicleShape vehicle;
    for (int i = 0; i < 5; ++i) {
      const auto point = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); };
      const Vec3 a = point();
      ASSERT_TRUE(
          vehicle.boxes.push_back({point(), Vec3(random.uniform(0.01, 0.5), random.uniform(0.01, 0.5), random.uniform(0.01, 0.5))}));
      ASSERT_TRUE(vehicle.rods.push_back({a, i == 0 ? a : point(), random.uniform(0.01, 0.1)}));
    }
    const LinkCapsules capsules = test::arm5e.link_capsules(random.next(), random.uniform(0, 1));
    double least = 1e9;
    for (const Capsule& c : capsules) {
      if (c.link == 1) continue;
      for (const VehicleShape::Box& box : vehicle.boxes) {
        Pose pose = Pose::Identity();
        pose.translation() = box.centre_m;
        least = std::min(least, clearance_to_box(c, pose, box.size_m));
      }
      for (const VehicleShape::Rod& rod : vehicle.rods) {
        const auto to_rod = [&](const Vec3& p) {
          const Vec3 way = rod.b_m - rod.a_m;
          const double along = way.squaredNorm() > 0 ? std::clamp(way.dot(p - rod.a_m) / way.squaredNorm(), 0.0, 1.0) : 0;
          return (p - rod.a_m - way * along).norm();
        };
        least = std::min(least, sampled(c, to_rod) - rod.radius_m);
      }
    }
    ASSERT_NEAR(clearance_to_vehicle(capsules, vehicle), least, 1e-4) << "draw " << k;
  }
  EXPECT_EQ(clearance_to_vehicle(test::arm5e.link_capsules(planar_joints(0, 1, 1, 0), 0), {}), HUGE_VAL);
}

// Its bounding boxes may only save work.
TEST(PanelShape, IsAsFarAsTheNearestOfItsSolids) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  RandomJoints random(seed);
  const PanelLayout layout;
  const PanelShape shape(layout);
  const PanelLayout::Valve& valve = layout.valves[0];
  const PanelLayout::Marker& tag = layout.markers[0];
  const double disc = std::hypot(valve.handle_length_m, valve.handle_thickness_m) / 2;
  for (int k = 0; k < 2000; ++k) {
    Pose base_from_panel = layout.nominal_base_from_panel();
    base_from_panel.translation() += Vec3(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2));
    base_from_panel.rotate(Eigen::AngleAxisd(random.uniform(-0.5, 0.5), Vec3(1, random.uniform(-1, 1), 0.3).normalized()));
    const LinkCapsules capsules = test::arm5e.link_capsules(random.next(), random.uniform(0, 1));
    const auto at = [&](double x, double y, double z) { return Pose(base_from_panel * Eigen::Translation3d(x, y, z)); };
    double least = 1e9;
    for (const Capsule& c : capsules) {
      const Vec2 size = layout.plate_max_m - layout.plate_min_m, middle = (layout.plate_max_m + layout.plate_min_m) / 2;
      const double thick = layout.plate_thickness_m, marker = tag.plate_m, high = tag.plate_thickness_m;
      least = std::min(least, clearance_to_box(c, at(middle.x(), middle.y(), -thick / 2), Vec3(size.x(), size.y(), thick)));
      least = std::min(least, clearance_to_box(c, at(tag.centre_m.x(), tag.centre_m.y(), high / 2), Vec3(marker, marker, high)));
      for (const PanelLayout::Button& button : layout.buttons) {
        const Vec3 cap(button.width_m, button.width_m, button.height_m);
        least = std::min(least, clearance_to_box(c, at(button.at_m.x(), button.at_m.y(), button.height_m / 2), cap));
      }
      least = std::min(least, clearance_to_cylinder(c, at(0, 0, valve.handle_height_m), disc, valve.handle_thickness_m));
      least = std::min(least, clearance_to_cylinder(c, at(0, 0, valve.handle_height_m / 2), valve.stem_radius_m, valve.handle_height_m));
    }
    ASSERT_NEAR(shape.clearance(capsules, base_from_panel).distance_m, least, 1e-12) << "draw " << k;
  }
}

}  // namespace
}  // namespace lf::arm
