#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "shared/arm/arm_description.hpp"
#include "shared/arm/arm_geometry.hpp"
#include "shared/arm/motor.hpp"
#include "shared/input_error.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string urdf_path = LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf";

std::string shipped_urdf() {
  std::ifstream stream(urdf_path);
  return (std::stringstream() << stream.rdbuf()).str();
}

// Named after the running test, so that tests may run side by side.
std::string temporary_file(const std::string& ending) {
  std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
  std::replace(name.begin(), name.end(), '/', '_');
  return testing::TempDir() + "lanternfish_" + name + ending;
}

// A URDF like the shipped one but for one replaced text, in a file of its own.
class ChangedUrdf {
 public:
  ChangedUrdf(const std::string& text, const std::string& replacement) {
    std::string urdf = shipped_urdf();
    const std::size_t at = urdf.find(text);
    EXPECT_NE(at, std::string::npos) << text;
    line_ = 1 + static_cast<int>(std::count(urdf.begin(), urdf.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
    std::ofstream(path_) << urdf.replace(at, text.size(), replacement);
  }
  ~ChangedUrdf() { std::filesystem::remove(path_); }
  ChangedUrdf(const ChangedUrdf&) = delete;
  ChangedUrdf& operator=(const ChangedUrdf&) = delete;

  const std::string& path() const { return path_; }
  std::string place() const { return path_ + ":" + std::to_string(line_) + ": "; }

 private:
  std::string path_ = temporary_file(".urdf");
  int line_ = 0;
};

std::string error_of(const std::string& path) {
  try {
    load_arm_urdf(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ArmUrdf, HasThePublishedLimits) {
  const ArmDescription arm = load_arm_urdf(urdf_path);
  const double published[][2] = {{-1.5708, 0.5488}, {0, 1.58665}, {0, 2.15294}, {-pi, pi}, {-0.05816, 1.3377}};
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    EXPECT_EQ(arm.joints[i].lower_rad, published[i][0]);
    EXPECT_EQ(arm.joints[i].upper_rad, published[i][1]);
  }
}

TEST(ArmUrdf, WeighsWhatAnArmOfThisSizeMay) {
  const ArmDescription arm = load_arm_urdf(urdf_path);
  double mass_kg = 0, wet_n = 0;
  for (std::size_t i = 1; i < arm.links.size(); ++i) {
    mass_kg += arm.links[i].mass_kg;
    wet_n += arm.links[i].wet_weight_n;
    EXPECT_FALSE(arm.links[i].shapes.empty());
  }
  EXPECT_GT(mass_kg, 8);
  EXPECT_LT(mass_kg, 15);
  EXPECT_LT(wet_n, 0.15 * 9.81 * mass_kg) << "near neutral";
}

TEST(ArmUrdf, FingersMirrorEachOther) {
  const ArmDescription arm = load_arm_urdf(urdf_path);
  const Mat3 mirror = Vec3(-1, 1, 1).asDiagonal();
  const ArmLink &a = arm.links[5], &b = arm.links[6];
  ASSERT_EQ(a.shapes.size(), b.shapes.size());
  for (std::size_t i = 0; i < a.shapes.size(); ++i)
    EXPECT_LT((mirror * a.shapes[i].body_from_shape.translation() - b.shapes[i].body_from_shape.translation()).norm(), 1e-12);
  EXPECT_EQ(arm.joints[4].axis, -arm.finger_b.axis);
}

// A motor pushes its joint with the rated torque through friction, and holds a load through what friction takes off it.
TEST(ArmDescription, ADriveHoldsMoreThanItPushes) {
  const ArmDescription arm = load_arm_urdf(urdf_path);
  const PerJoint<double> held_nm{56.4, 56.4, 56.4, 9.7, 44.9};
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    EXPECT_NEAR(held_torque_nm(arm.joints[i]), held_nm[i], 0.05) << arm.joints[i].name;
    ArmJoint locked = arm.joints[i];
    locked.friction.back_efficiency = 0;
    EXPECT_EQ(held_torque_nm(locked), locked.rated_torque_nm);
  }
}

// A joint whose peak torque is its rated one has such a motor, too, whatever the rounding: one whose rating is above its peak is refused.
TEST(ArmDescription, NoMotorIsRatedAboveItsPeak) {
  ArmJoint jaw = load_arm_urdf(urdf_path).joints[4];
  ASSERT_EQ(jaw.effort_nm, jaw.rated_torque_nm);
  for (int i = 0; i < 4000; ++i) {
    const double counts_per_rev = 20 + 0.5 * i;
    const Motor motor = motor_of(jaw, counts_per_rev);
    ASSERT_GE(motor.peak_torque_nm, motor.rated_torque_nm) << counts_per_rev;
    ASSERT_NEAR(motor.peak_torque_nm, motor.rated_torque_nm, 1e-12) << counts_per_rev;
  }
}

// Else an arm would give way as its power goes, and a jaw let go of what it has gripped.
TEST(ArmDescription, EveryGearHoldsWithoutPowerWhatItsDriveHolds) {
  for (const ArmJoint& joint : load_arm_urdf(urdf_path).joints) EXPECT_GT(joint.holding_torque_nm, held_torque_nm(joint)) << joint.name;
}

// What the build made of the URDF for the core is what the hosted side reads in it.
TEST(ArmGeometry, IsWhatTheUrdfSays) {
  const ArmDescription arm = load_arm_urdf(urdf_path);
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
    const ArmJoint& joint = arm.joints[i];
    const arm_geometry::JointNumbers& n = arm_geometry::joints[i];
    EXPECT_EQ(n.lower_rad, joint.lower_rad);
    EXPECT_EQ(n.upper_rad, joint.upper_rad);
    EXPECT_EQ(n.effort_nm, joint.effort_nm);
    EXPECT_EQ(n.rated_torque_nm, joint.rated_torque_nm);
    EXPECT_EQ(n.velocity_rad_s, joint.velocity_rad_s);
    EXPECT_EQ(n.acceleration_rad_s2, joint.acceleration_rad_s2);
    EXPECT_EQ(n.stiction_rad_s, joint.stiction_rad_s);
    EXPECT_EQ(n.backlash_rad, joint.backlash_rad);
    EXPECT_EQ(n.holding_torque_nm, joint.holding_torque_nm);
    EXPECT_EQ(n.pivot_a_m, joint.actuator.pivot_a_m);
    EXPECT_EQ(n.pivot_b_m, joint.actuator.pivot_b_m);
    EXPECT_EQ(n.offset_rad, joint.actuator.offset_rad);
    EXPECT_EQ(n.counts_per_m, joint.actuator.counts_per_m);
    EXPECT_EQ(n.counts_per_rad, joint.actuator.counts_per_rad);
  }
  for (std::size_t i = 0; i < arm5e_joint::count + 1; ++i) {
    const Pose& pose = i < arm5e_joint::count ? arm.joints[i].parent_from_joint : arm.finger_b.parent_from_joint;
    for (int r = 0; r < 3; ++r) {
      EXPECT_EQ(arm_geometry::joint_origins[i].translation_m[static_cast<std::size_t>(r)], pose.translation()[r]);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(arm_geometry::joint_origins[i].rotation[static_cast<std::size_t>(3 * r + c)], pose.linear()(r, c), 1e-15);
    }
  }
}

TEST(ArmGeometry, HasThePublishedDhTable) {
  const double table[4][4] = {{0.08052, pi / 2, 0, 0}, {0.44278, 0, 0, 0.139277}, {-0.083, pi / 2, 0, 1.972222}, {0, 0, 0.49257, 0}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(arm_geometry::dh[i].a_m, table[i][0], 1e-12);
    EXPECT_NEAR(arm_geometry::dh[i].alpha_rad, table[i][1], 1e-12);
    EXPECT_NEAR(arm_geometry::dh[i].d_m, table[i][2], 1e-12);
    EXPECT_NEAR(arm_geometry::dh[i].theta_offset_rad, table[i][3], 1e-12);
  }
  EXPECT_NEAR(arm_geometry::mount_yaw_rad, pi, 1e-12);
}

struct BadUrdf {
  const char* text;
  const char* replacement;
  const char* message;
};

void PrintTo(const BadUrdf& bad, std::ostream* stream) { *stream << bad.message; }

class BadUrdfs : public testing::TestWithParam<BadUrdf> {};

TEST_P(BadUrdfs, AreRefusedInOneLineWithTheirPlace) {
  const ChangedUrdf urdf(GetParam().text, GetParam().replacement);
  const std::string error = error_of(urdf.path());
  EXPECT_THAT(error, HasSubstr(GetParam().message));
  EXPECT_THAT(error, StartsWith(urdf.path() + ":"));
  EXPECT_EQ(error.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    ArmUrdf, BadUrdfs,
    testing::Values(BadUrdf{"<joint name=\"elbow\"", "<joint name=\"elbo\"", "no <joint> named 'elbow'"},
                    BadUrdf{"<link name=\"wrist\"", "<link name=\"hand\"", "no <link> named 'wrist'"},
                    BadUrdf{"lower=\"0\" upper=\"1.58665\"", "lower=\"1.6\" upper=\"1.58665\"", "lower limit is not below the upper one"},
                    BadUrdf{"upper=\"1.58665\"", "upper=\"nan\"", "upper=\"nan\" is not a number"},
                    BadUrdf{"upper=\"1.58665\"", "upper=\"6.3\"", "beyond a whole turn"},
                    BadUrdf{"upper=\"3.141592653589793\"", "upper=\"3.2\"", "must stay within half a turn"},
                    BadUrdf{"upper=\"1.58665\"", "", "has no upper"}, BadUrdf{"effort=\"100\"", "effort=\"0\"", "effort must be positive"},
                    BadUrdf{"effort=\"100\"", "effort=\"901\"", "is more than 30 times rated_torque_nm"},
                    BadUrdf{"<mass value=\"3.4\"/>", "<mass value=\"-3.4\"/>", "value must be positive"},
                    BadUrdf{"ixx=\"0.005\"", "ixx=\"-0.005\"", "not positive definite"},
                    BadUrdf{"ixx=\"0.005\"", "ixx=\"0.5\"", "of no real body"},
                    BadUrdf{"<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 2\"/>", "not a unit vector"},
                    BadUrdf{"<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 1\"/>", "is not 3 numbers"},
                    BadUrdf{"<axis xyz=\"0 0 1\"/>", "<axis xyz=\"1 0 0\"/>", "must turn about its own z"},
                    BadUrdf{"xyz=\"0.08052 0 0\" rpy=\"1.5707963267948966", "xyz=\"0.08052 0.01 0\" rpy=\"1.5707963267948966",
                            "'shoulder' must turn about the slew's -y"},
                    BadUrdf{"rpy=\"0 0 0.139277\"/>\n    <axis", "rpy=\"0 0.1 0.139277\"/>\n    <axis", "must be parallel to the shoulder"},
                    BadUrdf{"xyz=\"0 0 0.1485\"", "xyz=\"0.01 0 0.1485\"", "must lie on the roll axis"},
                    BadUrdf{"<child link=\"upper_arm\"/>", "<child link=\"forearm\"/>", "its child must be link 'upper_arm'"},
                    BadUrdf{"joint name=\"roll\" type=\"revolute\"", "joint name=\"roll\" type=\"prismatic\"", "must be of type revolute"},
                    BadUrdf{"stiction_rad_s=\"0.2\"", "stiction_rad_s=\"2\"", "it can never move"},
                    BadUrdf{"offset_rad=\"0.2115\"", "offset_rad=\"1.2\"", "dead centre"},
                    BadUrdf{"multiplier=\"1\"", "multiplier=\"2\"", "must mimic 'jaw'"},
                    BadUrdf{"<cylinder radius=\"0.036\"", "<cylinder radius=\"0\"", "radius must be positive"},
                    BadUrdf{"<cylinder radius=\"0.036\" length=\"0.44278\"/>", "<cone/>", "holds none of"},
                    BadUrdf{"coefficient=\"0.8\"", "coefficient=\"-1\"", "coefficient must not be negative"},
                    BadUrdf{"rpy=\"1.5707963267948966 0 1.972222\"", "rpy=\"-1.5707963267948966 0 1.972222\"",
                            "must have its y along the elbow's axis"},
                    BadUrdf{"<origin xyz=\"0.438492396133363 0.0614698863934362 0\"", "<origin xyz=\"0 0 0\"",
                            "'elbow' must stand more than 10 mm from the shoulder"},
                    BadUrdf{"<link name=\"tool\"/>", "<link name=\"tool\"/><link name=\"camera\"><collision/></link>",
                            "link 'camera': nobody keeps its collision shapes clear"},
                    BadUrdf{"<link name=\"tool\"/>", "<link name=\"tool\"/><link name=\"wrist\"/>", "link 'wrist' is there twice"},
                    BadUrdf{"<link name=\"tool\"/>", "<link name=\"tool\"/><joint name=\"pitch\" type=\"revolute\"/>",
                            "joint 'pitch' can move, and is none of the arm's"},
                    BadUrdf{"lower=\"-0.05816\" upper=\"1.3377\" effort=\"20\" velocity=\"0.5\"/>\n    <lanternfish:drive",
                            "lower=\"-0.2\" upper=\"1.3377\" effort=\"20\" velocity=\"0.5\"/>\n    <lanternfish:drive",
                            "must not close so far that its pads overlap"},
                    BadUrdf{"rad_per_count=\"3.14e-3\"", "rad_per_count=\"1e-10\"", "more counts than 32 bits hold"},
                    BadUrdf{"<collision name=\"pad\">", "<collision name=\"pd\">", "has no <collision> named 'pad'"},
                    BadUrdf{"<origin xyz=\"-0.04 0 0.045\"", "<origin xyz=\"-0.04 0.01 0.045\"", "must turn about the wrist's -y"},
                    BadUrdf{"<origin xyz=\"0.04 0 0.045\"", "<origin xyz=\"0.05 0 0.045\"", "must be the mirror image of 'jaw'"},
                    BadUrdf{"rgba=\"0.10", "rgba=\"1.10", "rgba must lie within 0 and 1"},
                    BadUrdf{"velocity=\"0.36\"", "velocity=\"1e300\"", "velocity=\"1e300\" is more than any arm has: 100 at most"},
                    BadUrdf{"acceleration_rad_s2=\"0.5\"", "acceleration_rad_s2=\"1e300\"", "is more than any arm has: 10000 at most"},
                    BadUrdf{"xyz=\"0 0 0.1485\"", "xyz=\"0 0 148.5\"", "is more than any arm has: 10 at most"},
                    BadUrdf{"rpy=\"1.5707963267948966 0 1.972222\"", "rpy=\"90 0 113\"", "is more than any arm has: 7 at most"},
                    BadUrdf{"<child link=\"upper_arm\"/>", "<child link=\"upper_arm\"/><child link=\"upper_arm\"/>", "comes a second time"},
                    BadUrdf{"<child link=\"upper_arm\"/>", "<child link=\"upper_arm\"/><chlid link=\"base\"/>", "is not known here"},
                    BadUrdf{"</robot>", "", "is not well-formed XML"}, BadUrdf{"<robot", "<robot2", "is not well-formed XML"}));

TEST(ArmUrdf, ErrorsGiveTheLine) {
  const ChangedUrdf urdf("effort=\"100\"", "effort=\"-1\"");
  EXPECT_THAT(error_of(urdf.path()), StartsWith(urdf.place()));
}

TEST(ArmUrdf, MissingEmptyAndForeignFilesAreNamed) {
  EXPECT_EQ(error_of("/nowhere/arm.urdf"), "/nowhere/arm.urdf: no such file");
  const std::string path = temporary_file(".urdf");
  std::ofstream(path).flush();
  EXPECT_EQ(error_of(path), path + ": is empty");
  std::ofstream(path) << "<!-- nothing else -->";
  EXPECT_EQ(error_of(path), path + ": has no element");
  std::ofstream(path) << "<scene/>";
  EXPECT_EQ(error_of(path), path + ":1: expected <robot>, found <scene>");
  std::filesystem::remove(path);
  EXPECT_FALSE(error_of(testing::TempDir()).empty()) << "a folder";
}

// The generator, as the build runs it.
struct Generated {
  int status;
  std::string error;
  bool header;
};

Generated generate(const std::string& urdf) {
  const std::string base = temporary_file("");
  const std::string command = std::string(LANTERNFISH_PYTHON) + " " + LANTERNFISH_SOURCE_DIR + "/shared/arm/generate_arm_geometry.py " +
                              urdf + " " + base + ".hpp 2> " + base + ".err";
  const int status = std::system(command.c_str());
  std::ifstream stream(base + ".err");
  Generated result{WEXITSTATUS(status), (std::stringstream() << stream.rdbuf()).str(), std::filesystem::exists(base + ".hpp")};
  std::filesystem::remove(base + ".err");
  std::filesystem::remove(base + ".hpp");
  return result;
}

TEST(ArmGeometryGenerator, RefusesBadUrdfsInOneLineAndWritesNothing) {
  const BadUrdf bad_urdfs[] = {
      {"<joint name=\"elbow\"", "<joint name=\"elbo\"", "no <joint> named 'elbow'"},
      {"lower=\"0\" upper=\"1.58665\"", "lower=\"1.6\" upper=\"1.58665\"", "lower limit is not below"},
      {"upper=\"1.58665\"", "upper=\"nan\"", "is not a number"},
      {"rpy=\"0 0 0.139277\"/>\n    <axis", "rpy=\"0 0.1 0.139277\"/>\n    <axis", "closed forms need"},
      {"xyz=\"0.08052 0 0\" rpy=\"1.5707963267948966", "xyz=\"0.08052 0 0.01\" rpy=\"1.5707963267948966", "closed forms need"},
      {"</robot>", "", "is not well-formed XML"},
  };
  for (const BadUrdf& bad : bad_urdfs) {
    const ChangedUrdf urdf(bad.text, bad.replacement);
    const Generated result = generate(urdf.path());
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.error, HasSubstr(bad.message));
    EXPECT_THAT(result.error, StartsWith(urdf.path() + ":"));
    EXPECT_EQ(std::count(result.error.begin(), result.error.end(), '\n'), 1);
    EXPECT_FALSE(result.header);
  }
  EXPECT_EQ(generate("/nowhere/arm.urdf").error, "/nowhere/arm.urdf: No such file or directory\n");
}

TEST(ArmGeometryGenerator, WritesAHeaderForTheShippedUrdf) {
  const Generated result = generate(urdf_path);
  EXPECT_EQ(result.status, 0) << result.error;
  EXPECT_TRUE(result.header);
}

}  // namespace
}  // namespace lf
