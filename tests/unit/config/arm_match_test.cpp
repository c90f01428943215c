#include "hal/config/arm_match.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/config/share.hpp"

namespace lf::config {
namespace {

using testing::HasSubstr;

ArmDescription shipped() { return load_arm_urdf(share_folder() / "arm" / "arm5e.urdf"); }

TEST(ArmMatch, TheShippedArmIsTheCores) { EXPECT_EQ(difference_from_core(shipped()), ""); }

TEST(ArmMatch, AnArmWithALongerForearmIsToldByHowFarItsToolIsOff) {
  ArmDescription longer = shipped();
  longer.wrist_from_tool.translate(Vec3(0, 0, 0.0312));
  EXPECT_EQ(difference_from_core(longer), "its tool is up to 31.20 mm and 0.000 degrees off");
}

TEST(ArmMatch, OtherLimitsAreNamedByTheirJoints) {
  ArmDescription other = shipped();
  other.joints[0].upper_rad += 0.1;
  other.joints[2].lower_rad -= 0.1;
  EXPECT_EQ(difference_from_core(other), "the limits of slew, elbow differ");
}

TEST(ArmMatch, AnotherScrewGearOrFingerIsNamed) {
  ArmDescription other = shipped();
  other.joints[2].actuator.counts_per_m = 250000;
  other.joints[3].actuator.counts_per_rad *= 1.01;
  EXPECT_EQ(difference_from_core(other), "the screw or gear of elbow, roll differs");
  other = shipped();
  other.joints[1].actuator.pivot_b_m += 0.001;
  EXPECT_EQ(difference_from_core(other), "the screw or gear of shoulder differs");
  other = shipped();
  other.finger_b.parent_from_joint.translate(Vec3(0.001, 0, 0));
  EXPECT_EQ(difference_from_core(other), "its fingers are elsewhere on the wrist");
}

TEST(ArmMatch, AnotherMotorIsNamedByItsJoint) {
  const auto differs = [](const auto& change) {
    ArmDescription other = shipped();
    change(other.joints[1]);
    return difference_from_core(other);
  };
  const std::string said = "torque, speed or acceleration of shoulder differs";
  EXPECT_EQ(differs([](ArmJoint& joint) { joint.rated_torque_nm *= 2; }), said);
  EXPECT_EQ(differs([](ArmJoint& joint) { joint.effort_nm *= 2; }), said);
  EXPECT_EQ(differs([](ArmJoint& joint) { joint.velocity_rad_s *= 2; }), said);
  EXPECT_EQ(differs([](ArmJoint& joint) { joint.acceleration_rad_s2 *= 2; }), said);
}

TEST(ArmMatch, AThickerLinkIsToldByHowFarItStandsOut) {
  for (const scene::BodyId body :
       {scene::BodyId::slew, scene::BodyId::upper_arm, scene::BodyId::forearm, scene::BodyId::wrist, scene::BodyId::finger_b}) {
    ArmDescription other = shipped();
    ArmLink& link = other.links[static_cast<std::size_t>(body)];
    for (scene::Shape& shape : link.shapes) {
      if (shape.collides) shape.size_m.x() += 0.1, shape.size_m.y() += 0.1;
    }
    EXPECT_THAT(difference_from_core(other), HasSubstr("its " + link.name + " stands ")) << link.name;
  }
}

TEST(ArmMatch, AShapeThatNoCapsuleHoldsIsTold) {
  ArmDescription other = shipped();
  ArmLink& link = other.links[static_cast<std::size_t>(scene::BodyId::forearm)];
  for (const scene::ShapeKind kind : {scene::ShapeKind::sphere, scene::ShapeKind::capsule}) {
    scene::Shape extra;
    extra.kind = kind;
    extra.size_m = Vec3(0.06, 0, 0.02);
    link.shapes.push_back(extra);
    EXPECT_THAT(difference_from_core(other), HasSubstr("its " + link.name + " stands "));
    link.shapes.pop_back();
  }
}

TEST(ArmMatch, OtherPadsAreNamed) {
  ArmDescription other = shipped();
  for (scene::Shape& shape : other.links[static_cast<std::size_t>(scene::BodyId::finger_a)].shapes) {
    if (shape.collides && shape.kind == scene::ShapeKind::box) shape.size_m.z() *= 0.9;
  }
  EXPECT_EQ(difference_from_core(other), "its fingers' pads are others");
}

}  // namespace
}  // namespace lf::config
