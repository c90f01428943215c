// The thirteen traps that files of real arms hold.
#include <Eigen/Geometry>

#include "tests/unit/urdf/motion.hpp"
#include "tests/unit/urdf/urdf_text.hpp"

namespace lf::urdf::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string arms = LANTERNFISH_TEST_DATA "/arms/";

// A joint of a type between two links, with what else it holds.
std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& rest) {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/>" + rest +
         "</joint>\n";
}
const std::string z_axis = "<axis xyz=\"0 0 1\"/>";
std::string limit(const std::string& lower, const std::string& upper) {
  return "<limit lower=\"" + lower + "\" upper=\"" + upper + "\" effort=\"3\" velocity=\"4\"/>";
}

// 1. A slash is part of a name, and so is a space within. Two names that differ before the slash are two.
TEST(UrdfTrap1Names, WithSlashesAndSpacesAreKeptAsTheyAre) {
  std::string text = with(with(elbow, "<link name=\"arm\"/>", "<link name=\"/left/lower arm\"/>"), "<child link=\"arm\"/>",
                          "<child link=\"/left/lower arm\"/>");
  text = and_also(text, "<link name=\"/right/lower arm\"/>" + joint("j", "fixed", "base", "/right/lower arm", ""));
  const Mechanism mechanism = read_text(text);
  ASSERT_EQ(mechanism.links.size(), 3u);
  EXPECT_EQ(mechanism.links[1].name, "/left/lower arm");
  EXPECT_EQ(mechanism.links[2].name, "/right/lower arm");
  EXPECT_THAT(
      notes_of(text),
      ElementsAre(
          "arm.urdf:3: link '/left/lower arm' has a slash in its name. It is used as it is; some programs cut what stands before it",
          "arm.urdf:11: link '/right/lower arm' and '/left/lower arm' differ only before a slash. They are two here; some programs take "
          "them as one"));
}

TEST(UrdfTrap1Names, WithSpacesAtTheirEndsAreRefused) {
  EXPECT_EQ(error_of(with(elbow, "name=\"elbow\"", "name=\" elbow\"")),
            "arm.urdf:4: joint ' elbow' name=' elbow' begins or ends with white space or holds a control character: remove it");
}

// 2. The first of two origins, as urdfdom has it; a link's own origin places nothing.
TEST(UrdfTrap2Origins, OfTwoTheFirstIsUsedAndTheOtherTold) {
  const std::string text = with(elbow, "<axis", "<origin xyz=\"7 7 7\"/>\n    <axis");
  EXPECT_EQ(read_text(text).joints[0].parent_from_joint.translation(), Vec3(1, 2, 3));
  EXPECT_THAT(notes_of(text),
              ElementsAre("arm.urdf:8: <origin> of joint 'elbow' comes a second time; the first is used, as other readers do. Remove one"));
}

TEST(UrdfTrap2Origins, OfALinkPlaceNothingAndAreTold) {
  const std::string text = with(elbow, "<link name=\"arm\"/>", "<link name=\"arm\"><origin xyz=\"7 7 7\"/></link>");
  EXPECT_THAT(notes_of(text), ElementsAre("arm.urdf:3: <origin> of link 'arm' is not used"));
}

// 3. Limits by type.
TEST(UrdfTrap3Limits, OfNoWidthMakeAJointFixedWhereItStands) {
  const std::string text = with(elbow, "lower=\"-1\" upper=\"2\"", "lower=\"0.5\" upper=\"0.5\"");
  const Joint joint = read_text(text).joints[0];
  EXPECT_EQ(joint.type, JointType::fixed);
  EXPECT_FALSE(joint.range.has_value());
  // cos and sin of half a radian, by hand.
  EXPECT_LT((joint.parent_from_joint.linear().col(0) - Vec3(0.8775825618903728, 0.479425538604203, 0)).norm(), 1e-15);
  EXPECT_EQ(joint.parent_from_joint.translation(), Vec3(1, 2, 3));
  EXPECT_THAT(notes_of(text), ElementsAre("arm.urdf:9: <limit> of joint 'elbow' has lower = upper: the joint is taken as fixed there"));
}

TEST(UrdfTrap3Limits, OfNoWidthFixASlidingJointAlongItsAxis) {
  const std::string text = with(with(elbow, "revolute", "prismatic"), "lower=\"-1\" upper=\"2\"", "lower=\"0.5\" upper=\"0.5\"");
  EXPECT_EQ(read_text(text).joints[0].parent_from_joint.translation(), Vec3(1, 2, 3.5));
}

TEST(UrdfTrap3Limits, MayOnlyBeMissingWhereTheJointIsContinuous) {
  const std::string without = with(elbow, "<limit lower=\"-1\" upper=\"2\" effort=\"3\" velocity=\"4\"/>", "");
  EXPECT_EQ(error_of(without), "arm.urdf:4: joint 'elbow' has no limit: give one, or make the joint continuous");
  EXPECT_THAT(error_of(with(without, "revolute", "prismatic")), HasSubstr("arm.urdf:4: joint 'elbow' has no limit: give one with lower"));
  const Joint continuous = read_text(with(without, "revolute", "continuous")).joints[0];
  EXPECT_EQ(continuous.type, JointType::continuous);
  EXPECT_FALSE(continuous.range.has_value() || continuous.effort.has_value() || continuous.velocity.has_value());
  EXPECT_THAT(notes_of(with(without, "revolute", "continuous")), IsEmpty());
}

TEST(UrdfTrap3Limits, OfAContinuousJointAreToldAndNotUsed) {
  const std::string text = with(elbow, "revolute", "continuous");
  const Joint joint = read_text(text).joints[0];
  EXPECT_FALSE(joint.range.has_value());
  EXPECT_EQ(joint.effort, 3);
  EXPECT_EQ(joint.velocity, 4);
  EXPECT_THAT(notes_of(text),
              ElementsAre("arm.urdf:9: <limit> of joint 'elbow' has lower or upper, which are not used: the joint is continuous. Make it "
                          "revolute if they are meant"));
}

// 4. Rounded rotations stay as they are written; axes become unit vectors.
TEST(UrdfTrap4Rounding, OfRotationsIsNotMendedButToldWhereItCanBeMeasured) {
  const auto y_axis = [](const std::string& roll) {
    return Vec3(read_text(with(elbow, "rpy=\"0 0 0\"", "rpy=\"" + roll + " 0 0\"")).joints[0].parent_from_joint.linear().col(1));
  };
  // sin(pi/2 - x) is 1 - x^2/2: the cosine alone shows the rounding.
  EXPECT_NEAR(y_axis("1.5708").y(), -3.6732e-6, 1e-10);
  EXPECT_NEAR(y_axis("1.570796327").y(), -2.0510e-10, 1e-13);
  EXPECT_THAT(notes_of(with(elbow, "rpy=\"0 0 0\"", "rpy=\"1.5708 0 0\"")),
              ElementsAre("arm.urdf:7: <origin> of joint 'elbow' has an rpy 3.673e-06 rad off a multiple of a right angle. It is used as "
                          "it is; write more digits"));
  EXPECT_THAT(notes_of(with(elbow, "rpy=\"0 0 0\"", "rpy=\"1.570796327 0 0\"")), IsEmpty());
  EXPECT_THAT(notes_of(with(elbow, "rpy=\"0 0 0\"", "rpy=\"1.2 0 0\"")), IsEmpty());
}

TEST(UrdfTrap4Rounding, OfAxesIsTakenOff) {
  const std::string text = with(elbow, "xyz=\"0 0 1\"", "xyz=\"0 3 4\"");
  EXPECT_LT((read_text(text).joints[0].axis - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_THAT(notes_of(text),
              ElementsAre("arm.urdf:8: <axis> of joint 'elbow' is no unit vector: its length is 5.000000. Its direction is used"));
}

TEST(UrdfTrap4Rounding, AnAbsentAxisIsX) {
  const std::string text = with(elbow, z_axis, "");
  EXPECT_EQ(read_text(text).joints[0].axis, Vec3::UnitX());
  EXPECT_THAT(notes_of(text), ElementsAre("arm.urdf:4: joint 'elbow' has no axis: it is 1 0 0"));
}

// 5. What stands for "not known" is no rating.
TEST(UrdfTrap5Ratings, ZeroAndAThousandAreNotKnown) {
  const std::string text = with(elbow, "effort=\"3\" velocity=\"4\"", "effort=\"1000.0\" velocity=\"0\"");
  const Joint joint = read_text(text).joints[0];
  EXPECT_FALSE(joint.effort.has_value() || joint.velocity.has_value());
  EXPECT_THAT(
      notes_of(text),
      ElementsAre(
          "arm.urdf:9: <limit> of joint 'elbow' has effort 1000, which stands for \"not known\" in many files: it is taken as not known",
          "arm.urdf:9: <limit> of joint 'elbow' has velocity 0, which stands for \"not known\" in many files: it is taken as not known"));
  EXPECT_EQ(read_text(with(elbow, "effort=\"3\"", "effort=\"5000\"")).joints[0].effort, 5000);
}

// 6. Ranges.
TEST(UrdfTrap6Ranges, OfSeveralTurnsAreKept) {
  const Joint joint = read_text(with(elbow, "lower=\"-1\" upper=\"2\"", "lower=\"-6.283185307\" upper=\"6.283185307\"")).joints[0];
  EXPECT_EQ(joint.range->lower, -6.283185307);
  EXPECT_EQ(joint.range->upper, 6.283185307);
}

TEST(UrdfTrap6Ranges, ThatDoNotHoldZeroAreTold) {
  const std::string text = with(elbow, "lower=\"-1\" upper=\"2\"", "lower=\"-3.0718\" upper=\"-0.0698\"");
  EXPECT_THAT(notes_of(text), ElementsAre("arm.urdf:9: <limit> of joint 'elbow' does not hold 0: the joint cannot stand there"));
  EXPECT_DOUBLE_EQ(read_text(text).joints[0].range->middle(), -1.5708);
}

TEST(UrdfTrap6Ranges, ThatAreUpsideDownAreRefused) {
  EXPECT_EQ(error_of(with(elbow, "lower=\"-1\" upper=\"2\"", "lower=\"2\" upper=\"-1\"")),
            "arm.urdf:9: <limit> of joint 'elbow' has lower above upper: exchange them");
}

// 7. A rod (m) moves a finger (rad), which a second one mimics. Bravo's figures: 10 mm, 54 rad/m.
TEST(UrdfTrap7Mimics, OfMimicsWithOffsetsAcrossTypesAreFollowed) {
  const std::string text = and_also(
      "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\"/><link name=\"d\"/></robot>\n",
      joint("tip", "revolute", "b", "c", z_axis + limit("-2", "2") + "<mimic joint=\"finger\" multiplier=\"-2\" offset=\"0.5\"/>") +
          joint("finger", "revolute", "a", "b", z_axis + limit("-1", "1") + "<mimic joint=\"rod\" multiplier=\"54\" offset=\"0.1\"/>") +
          joint("rod", "prismatic", "a", "d", z_axis + limit("0", "0.01")));
  const Mechanism mechanism = read_text(text);
  const std::size_t rod = mechanism.joint("rod"), finger = mechanism.joint("finger"), tip = mechanism.joint("tip");
  EXPECT_EQ(mechanism.joints[tip].mimic->joint, finger);
  const Mimic driver = mechanism.driver(tip);
  EXPECT_EQ(driver.joint, rod);
  EXPECT_DOUBLE_EQ(driver.multiplier, -108);
  EXPECT_DOUBLE_EQ(driver.offset, 0.3);
  EXPECT_EQ(mechanism.driver(rod).joint, rod);
  // All from the rod's 4 mm: 0.316 and -0.132 rad.
  const std::vector<std::size_t> free{rod};
  const std::vector<double> at{0.004};
  const std::vector<double> q = coordinates(mechanism, free, at);
  EXPECT_NEAR(q[finger], 0.316, 1e-12);
  EXPECT_NEAR(q[tip], -0.132, 1e-12);
  EXPECT_THAT(notes_of(text), IsEmpty());
}

TEST(UrdfTrap7Mimics, ThatWouldLeaveTheirOwnRangeAreTold) {
  const std::string text = and_also(elbow, "<link name=\"finger\"/>\n" + joint("f", "revolute", "base", "finger",
                                                                               z_axis + limit("0", "1") + "\n<mimic joint=\"elbow\"/>"));
  EXPECT_THAT(
      notes_of(text),
      ElementsAre(
          "arm.urdf:13: joint 'f' is moved by 'elbow', whose whole range would take it from -1.000000 to 2.000000, beyond its own limits"));
}

TEST(UrdfTrap7Mimics, ParallelFingersWithoutAnyStayFree) {
  const Mechanism panda = read_urdf(arms + "panda/panda.urdf").mechanism;
  for (const char* finger : {"panda_finger_joint1", "panda_finger_joint2"})
    EXPECT_EQ(panda.driver(panda.joint(finger)).joint, panda.joint(finger));
  const Mechanism robotis = read_urdf(arms + "open_manipulator_x/open_manipulator_x.urdf").mechanism;
  EXPECT_EQ(robotis.driver(robotis.joint("gripper_right_joint")).joint, robotis.joint("gripper_left_joint"));
}

// 8. Fixed joints at both ends, a world link, fingers that hang on the hand: none is part of the chain that moves the tool.
TEST(UrdfTrap8Chains, LeaveOutFixedJointsAndWhatHangsBeside) {
  const Mechanism ur5 = read_urdf(arms + "ur5/ur5.urdf").mechanism;
  const std::vector<Step> path = ur5.path(Mechanism::root, ur5.link("tool0"));
  EXPECT_EQ(path.size(), 9u);
  std::vector<std::string> names;
  for (const std::size_t joint : ur5.free_joints(path)) names.push_back(ur5.joints[joint].name);
  EXPECT_THAT(names,
              ElementsAre("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"));
  const Mechanism panda = read_urdf(arms + "panda/panda.urdf").mechanism;
  EXPECT_EQ(panda.free_joints(panda.path(Mechanism::root, panda.link("tool"))).size(), 7u);
}

TEST(UrdfTrap8Chains, MayBeginAtAWorld) {
  const Mechanism mechanism =
      read_text(and_also(elbow, "<link name=\"world\"/>" + joint("mount", "fixed", "world", "base", "<origin xyz=\"0 0 9\"/>")));
  EXPECT_EQ(mechanism.links[0].name, "world");
  const std::vector<Step> path = mechanism.path(0, mechanism.link("arm"));
  EXPECT_EQ(mechanism.free_joints(path), std::vector<std::size_t>{mechanism.joint("elbow")});
  EXPECT_EQ(begin_from_end(mechanism, path, std::vector<double>(2, 0.0)).translation(), Vec3(1, 2, 12));
}

// 9. Masses.
TEST(UrdfTrap9Inertia, LinksWithoutStayAndAreTold) {
  EXPECT_THAT(Urdf(elbow).notes(), ElementsAre("arm.urdf:2: link 'base' has no inertial: it has no mass",
                                               "arm.urdf:3: link 'arm' has no inertial: it has no mass"));
  EXPECT_EQ(read_text(elbow).links.size(), 2u);
}

TEST(UrdfTrap9Inertia, OfZeroThroughoutIsNone) {
  const std::string text = with(with(body, "value=\"2\"", "value=\"0\""), "ixx=\"2\" ixy=\"0\" ixz=\"0\" iyy=\"3\" iyz=\"0\" izz=\"4\"",
                                "ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"");
  EXPECT_FALSE(read_text(text).links[0].inertial.has_value());
  EXPECT_THAT(notes_of(text), ElementsAre("arm.urdf:3: <inertial> of link 'base' has mass 0 and inertia 0: the link has no mass"));
}

TEST(UrdfTrap9Inertia, ThatNoBodyCanHaveIsRefused) {
  EXPECT_THAT(error_of(with(body, "izz=\"4\"", "izz=\"5.1\"")),
              HasSubstr("arm.urdf:6: <inertia> of link 'base' is of no body: a principal moment exceeds the sum of the others"));
  EXPECT_EQ(error_of(with(body, "izz=\"4\"", "izz=\"5\"")), "") << "a thin plate";
  // Moments that pass one by one, but whose matrix is indefinite: the product exceeds the geometric mean.
  EXPECT_THAT(error_of(with(body, "ixy=\"0\"", "ixy=\"2.5\"")), HasSubstr("arm.urdf:6: <inertia> of link 'base' is not positive definite"));
  // Along its diagonal it fulfils the inequality, about its principal axes it does not: 0.4, 2 and 3.6.
  EXPECT_THAT(
      error_of(with(with(body, "iyy=\"3\"", "iyy=\"2\""), "izz=\"4\"", "izz=\"2\"").replace(body.find("ixy=\"0\""), 7, "ixy=\"1.6\"")),
      HasSubstr("is of no body"));
  EXPECT_THAT(error_of(with(body, "value=\"2\"", "value=\"0\"")), HasSubstr("arm.urdf:5: <mass> of link 'base' has to be above 0"));
  EXPECT_THAT(error_of(with(body, "value=\"2\"", "value=\"-2\"")),
              HasSubstr("arm.urdf:5: <mass> of link 'base' value='-2': it has to be from 0"));
}

// 10. Mesh paths: mesh_test.cpp.

// 11. Makers disagree about the axis along which the hand approaches. The user says which; what comes out is the project's own tool frame.
TEST(UrdfTrap11ToolAxes, AreNamedByTheUser) {
  EXPECT_EQ(tool_axes("z", "x"), Mat3::Identity());
  for (const auto& [approach, opening] : {std::pair("z", "y"), std::pair("x", "y"), std::pair("x", "-z"), std::pair("-y", "x")}) {
    const Mat3 axes = tool_axes(approach, opening);
    EXPECT_NEAR(axes.determinant(), 1, 1e-15) << approach << opening;
    EXPECT_EQ(axes * axes.transpose(), Mat3::Identity());
  }
  EXPECT_EQ(tool_axes("x", "-z").col(2), Vec3::UnitX());
  EXPECT_EQ(tool_axes("x", "-z").col(0), -Vec3::UnitZ());
  // ROBOTIS: at rest the hand points along the root's x, and the fingers move along y.
  const Mechanism arm = read_urdf(arms + "open_manipulator_x/open_manipulator_x.urdf").mechanism;
  const auto path = arm.path(0, arm.link("end_effector_link"));
  const Pose tool = begin_from_end(arm, path, std::vector<double>(arm.joints.size(), 0.0));
  EXPECT_EQ(tool.linear() * tool_axes("x", "y").col(2), Vec3::UnitX());
  EXPECT_EQ(tool.linear() * tool_axes("x", "y").col(0), arm.joints[arm.joint("gripper_left_joint")].axis);
}

TEST(UrdfTrap11ToolAxes, OnOneLineOrMisspeltAreRefused) {
  EXPECT_EQ(lf::test::message_of<InputError>([] { (void)tool_axes("x", "-x"); }),
            "approach 'x' and opening '-x' lie on one line: they have to be square to each other");
  for (const char* word : {"", "-", "w", "xy", "--x", "X"})
    EXPECT_EQ(lf::test::message_of<InputError>([&] { (void)tool_axes(word, "y"); }),
              std::string("'") + word + "' is no axis: write x, y, z, -x, -y or -z");
}

// 12. Half a turn about all three axes is none.
TEST(UrdfTrap12Turns, OfPiAboutAllAxesAreTheIdentity) {
  const std::string text = with(elbow, "rpy=\"0 0 0\"", "rpy=\"3.141592653589793 3.141592653589793 3.141592653589793\"");
  EXPECT_LT((read_text(text).joints[0].parent_from_joint.linear() - Mat3::Identity()).norm(), 1e-15);
}

TEST(UrdfTrap12Xacro, ThatIsNotExpandedIsNamedWithItsRemedy) {
  const std::string remedy = ": it is a xacro that is not expanded. Run: xacro arm.urdf.xacro > arm.urdf";
  EXPECT_EQ(error_of(with(elbow, "upper=\"2\"", "upper=\"${pi/2}\"")), "arm.urdf:9: holds '${pi/2}'" + remedy);
  EXPECT_EQ(error_of(with(elbow, "name=\"arm\"", "name=\"$(arg prefix)arm\"")), "arm.urdf:3: holds '$(arg prefix)arm'" + remedy);
  EXPECT_EQ(error_of(with(elbow, "<link name=\"arm\"/>", "\n<xacro:include filename=\"x\"/>")),
            "arm.urdf:4: holds <xacro:include>" + remedy);
  EXPECT_EQ(error_of(and_also(elbow, "<gazebo><kp>${kp}</kp></gazebo>")), "arm.urdf:11: holds '${kp}'" + remedy);
}

// 13. Five joints that cannot roll the hand, four that can.
TEST(UrdfTrap13Freedom, IsNotTheNumberOfJoints) {
  const auto freedom_of = [](const std::string& file, const std::string& tool, const Vec3& approach) {
    const Mechanism mechanism = read_urdf(file).mechanism;
    return freedom(mechanism, mechanism.path(0, mechanism.link(tool)), approach);
  };
  const Freedom predator = freedom_of(arms + "predator/predator.urdf", "tool", Vec3::UnitZ());
  EXPECT_EQ(predator.joints, 5u);
  EXPECT_EQ(predator.dimensions, 5);
  EXPECT_TRUE(predator.translates);
  EXPECT_FALSE(predator.rolls);
  const Freedom arm5e = freedom_of(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf", "tool", Vec3::UnitZ());
  EXPECT_EQ(arm5e.joints, 4u);
  EXPECT_TRUE(arm5e.rolls && arm5e.translates);
  EXPECT_FALSE(freedom_of(arms + "open_manipulator_x/open_manipulator_x.urdf", "end_effector_link", Vec3::UnitX()).rolls);
  const Freedom panda = freedom_of(arms + "panda/panda.urdf", "tool", Vec3::UnitZ());
  EXPECT_EQ(panda.joints, 7u);
  EXPECT_EQ(panda.dimensions, 6);
  EXPECT_TRUE(panda.rolls);
}

}  // namespace
}  // namespace lf::urdf::test
