// What is valid, of no use here, and told with its line; and what is read in full.
#include "tests/unit/urdf/urdf_text.hpp"

namespace lf::urdf::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(UrdfTells, WhatOtherProgramsUse) {
  const std::string text = with(and_also(elbow,
                                         "<transmission name=\"t\"><type>x</type></transmission>\n<gazebo "
                                         "reference=\"arm\"><kp>1</kp></gazebo>\n<ros2_control name=\"c\" type=\"system\"/>\n"
                                         "<drake:joint name=\"d\"/>\n"),
                                "</joint>", "<safety_controller k_velocity=\"1\"/><calibration rising=\"0\"/></joint>");
  EXPECT_THAT(
      notes_of(text),
      ElementsAre("arm.urdf:10: <calibration> of joint 'elbow' is not used",
                  "arm.urdf:10: <safety_controller> of joint 'elbow' is not used: it has no soft limit within those of <limit>",
                  "arm.urdf:11: <transmission> 't' is not used", "arm.urdf:12: <gazebo> is not used",
                  "arm.urdf:13: <ros2_control> 'c' is not used", "arm.urdf:14: <drake:joint> 'd' is another program's and is not used"));
}

TEST(UrdfTells, AttributesOfOtherPrograms) {
  const std::string text = with(with(elbow, "velocity=\"4\"", "velocity=\"4\" acceleration=\"5\" drake:jerk=\"6\""), "<robot name",
                                "<robot xmlns:drake=\"https://drake.mit.edu\" name");
  EXPECT_THAT(notes_of(text),
              ElementsAre("arm.urdf:9: <limit> of joint 'elbow': attribute 'acceleration' is not used",
                          "arm.urdf:9: <limit> of joint 'elbow': attribute 'drake:jerk' is another program's and is not used"));
}

TEST(UrdfTells, WhatAFixedJointHasNoUseFor) {
  const std::string text = with(with(elbow, "revolute", "fixed"), "</joint>", "<dynamics damping=\"1\"/>\n<mimic joint=\"x\"/></joint>");
  EXPECT_THAT(notes_of(text), ElementsAre("arm.urdf:8: <axis> of joint 'elbow' is not used: the joint is fixed",
                                          "arm.urdf:9: <limit> of joint 'elbow' is not used: the joint is fixed",
                                          "arm.urdf:10: <dynamics> of joint 'elbow' is not used: the joint is fixed",
                                          "arm.urdf:11: <mimic> of joint 'elbow' is not used: the joint is fixed"));
}

TEST(UrdfTells, TextBetweenElements) {
  EXPECT_THAT(notes_of(with(elbow, "<axis", "1.0 <axis")),
              ElementsAre("arm.urdf:8: joint 'elbow' holds the text '1.0 ', which is not used"));
  EXPECT_THAT(notes_of(with(elbow, "<axis", "<!-- 1.0 --><axis")), IsEmpty());
}

TEST(UrdfTells, DefaultsThatWereAssumed) {
  EXPECT_THAT(notes_of(with(elbow, "lower=\"-1\"", "")), ElementsAre("arm.urdf:9: <limit> of joint 'elbow' has no lower: it is 0"));
  EXPECT_EQ(read_text(with(elbow, "lower=\"-1\"", "")).joints[0].range->lower, 0);
}

TEST(UrdfTells, AnglesThatLookLikeDegrees) {
  const std::string told =
      "arm.urdf:7: <origin> of joint 'elbow' has an rpy beyond half a turn. It is taken in radians; were degrees meant?";
  for (const char* const angle : {"90", "45", "-5", "3.2"})
    EXPECT_THAT(notes_of(with(elbow, "rpy=\"0 0 0\"", "rpy=\"0 " + std::string(angle) + " 0\"")), ElementsAre(told)) << angle;
  for (const char* const half_turn : {"3.141592653589793", "-3.14159265359"})
    EXPECT_THAT(notes_of(with(elbow, "rpy=\"0 0 0\"", "rpy=\"0 0 " + std::string(half_turn) + "\"")), IsEmpty()) << half_turn;
}

// As MoveIt and TRAC-IK take them.
TEST(UrdfTells, SoftLimitsThatAreTighter) {
  const auto soft = [](const std::string& keys) {
    return with(elbow, "</joint>", "<safety_controller k_velocity=\"9\" " + keys + "/></joint>");
  };
  const std::string begin = "arm.urdf:10: <safety_controller> of joint 'elbow' ";
  const std::string both = soft("k_position=\"20\" soft_lower_limit=\"-0.5\" soft_upper_limit=\"1.5\"");
  EXPECT_EQ(read_text(both).joints[0].range->lower, -0.5);
  EXPECT_EQ(read_text(both).joints[0].range->upper, 1.5);
  EXPECT_THAT(notes_of(both),
              ElementsAre(begin + "has soft limits that are used: the range is from -0.500000 to 1.500000, that of <limit> from "
                                  "-1.000000 to 2.000000"));
  // One that is not given is none; the specification's 0 would hold the joint still.
  EXPECT_EQ(read_text(soft("soft_lower_limit=\"-0.5\"")).joints[0].range->upper, 2);
  const std::string wider = soft("soft_lower_limit=\"-3\" soft_upper_limit=\"3\"");
  EXPECT_EQ(read_text(wider).joints[0].range->lower, -1);
  EXPECT_THAT(notes_of(wider), ElementsAre(begin + "is not used: it has no soft limit within those of <limit>"));
  EXPECT_EQ(notes_of(soft("soft_lower_limit=\"0.5\"")).back(), begin + "does not hold 0: the joint cannot stand there");
  EXPECT_EQ(error_of(soft("soft_lower_limit=\"3\"")), begin + "leaves no range between its soft limits and those of <limit>: correct them");
  EXPECT_NE(error_of(soft("soft_lower=\"3\"")).find("has an unknown attribute 'soft_lower'"), std::string::npos);
  EXPECT_THAT(notes_of(with(soft(""), "revolute", "continuous")).back(), begin + "is not used: the joint is continuous");
}

TEST(UrdfTells, RangesThatLookLikeDegrees) {
  EXPECT_THAT(notes_of(with(elbow, "upper=\"2\"", "upper=\"90\"")),
              ElementsAre("arm.urdf:9: <limit> of joint 'elbow' goes beyond a whole turn. It is taken in radians; were degrees meant?"));
  EXPECT_THAT(notes_of(with(with(elbow, "upper=\"2\"", "upper=\"6.2832\""), "lower=\"-1\"", "lower=\"-6.2832\"")), IsEmpty());
}

TEST(UrdfReads, EveryFigureOfAJoint) {
  const Joint joint = read_text(with(elbow, "</joint>", "<dynamics damping=\"0.5\" friction=\"0.25\"/></joint>")).joints[0];
  EXPECT_EQ(joint.name, "elbow");
  EXPECT_EQ(joint.type, JointType::revolute);
  EXPECT_EQ(joint.parent_from_joint.translation(), Vec3(1, 2, 3));
  EXPECT_EQ(joint.axis, Vec3::UnitZ());
  EXPECT_EQ(joint.range->lower, -1);
  EXPECT_EQ(joint.range->upper, 2);
  EXPECT_EQ(joint.effort, 3);
  EXPECT_EQ(joint.velocity, 4);
  EXPECT_EQ(joint.dynamics.damping, 0.5);
  EXPECT_EQ(joint.dynamics.friction, 0.25);
  EXPECT_FALSE(joint.mimic.has_value());
  EXPECT_EQ(joint.line, 4);
}

TEST(UrdfReads, EveryFigureOfALink) {
  const Link link = read_text(body).links[0];
  EXPECT_EQ(link.inertial->mass_kg, 2);
  EXPECT_EQ(link.inertial->link_from_com.translation(), Vec3(0, 0, 0.5));
  EXPECT_EQ(link.inertial->inertia_kg_m2.diagonal(), Vec3(2, 3, 4));
  ASSERT_EQ(link.visuals.size(), 1u);
  EXPECT_EQ(std::get<Box>(link.visuals[0].geometry).size_m, Vec3(1, 2, 3));
  EXPECT_FALSE(link.visuals[0].rgba.has_value());
  ASSERT_EQ(link.collisions.size(), 1u);
  EXPECT_EQ(std::get<Cylinder>(link.collisions[0].geometry).radius_m, 1);
  EXPECT_EQ(std::get<Cylinder>(link.collisions[0].geometry).length_m, 2);
}

TEST(UrdfReads, ProductsOfInertiaAtTheirPlaces) {
  std::string text = with(body, "ixy=\"0\"", "ixy=\"0.1\"");
  text = with(with(text, "ixz=\"0\"", "ixz=\"0.2\""), "iyz=\"0\"", "iyz=\"0.3\"");
  const Mat3 inertia = read_text(text).links[0].inertial->inertia_kg_m2;
  EXPECT_EQ(inertia(0, 1), 0.1);
  EXPECT_EQ(inertia(0, 2), 0.2);
  EXPECT_EQ(inertia(1, 2), 0.3);
  EXPECT_EQ(inertia, inertia.transpose());
}

TEST(UrdfReads, ColoursWhereverTheyAreDefined) {
  const std::string own = with(body, "<visual>", "<visual name=\"v\"><material name=\"own\"><color rgba=\"0.25 0.5 0.75 1\"/></material>");
  const std::array<float, 4> colour{0.25f, 0.5f, 0.75f, 1.f};
  EXPECT_EQ(read_text(own).links[0].visuals[0].rgba, colour);
  const std::string global = and_also(with(body, "<visual>", "<visual><material name=\"sea\"/>"),
                                      "<material name=\"sea\"><color rgba=\"0.25 0.5 0.75 1\"/></material>");
  EXPECT_EQ(read_text(global).links[0].visuals[0].rgba, colour);
  // A visual's definition serves later ones.
  const std::string second =
      with(own, "<collision>", "<visual><material name=\"own\"/><geometry><sphere radius=\"1\"/></geometry></visual><collision>");
  EXPECT_EQ(read_text(second).links[0].visuals[1].rgba, colour);
  const std::string textured = with(body, "<visual>", "<visual><material name=\"t\"><texture filename=\"t.png\"/></material>");
  EXPECT_FALSE(read_text(textured).links[0].visuals[0].rgba.has_value());
  EXPECT_THAT(notes_of(textured), ElementsAre("arm.urdf:8: <texture> of material 't' is not used"));
}

TEST(UrdfReads, OwnElementsByTheirKeys) {
  const std::string text =
      with(with(elbow, "</joint>", "<lanternfish:gear rad_per_count=\"0.25\"/></joint>"), "<link name=\"arm\"/>",
           "<link name=\"arm\"><lanternfish:wet_weight n=\"-3\"/><collision><geometry><sphere radius=\"1\"/></geometry>"
           "<lanternfish:friction coefficient=\"0.8\"/></collision></link>");
  const Mechanism mechanism = read_text(text);
  ASSERT_EQ(mechanism.joints[0].extensions.size(), 1u);
  EXPECT_EQ(mechanism.joints[0].extensions[0].element, "gear");
  EXPECT_EQ(mechanism.joints[0].extensions[0].line, 10);
  EXPECT_EQ(mechanism.joints[0].extensions[0].number("rad_per_count"), 0.25);
  EXPECT_FALSE(mechanism.joints[0].extensions[0].number("counts_per_rad").has_value());
  EXPECT_EQ(mechanism.links[1].extensions.at(0).number("n"), -3);
  EXPECT_EQ(mechanism.links[1].collisions.at(0).extensions.at(0).number("coefficient"), 0.8);
  EXPECT_THAT(notes_of(text), IsEmpty());
}

}  // namespace
}  // namespace lf::urdf::test
