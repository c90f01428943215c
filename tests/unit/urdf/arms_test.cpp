// Files of real arms, against what others computed of them: forward kinematics by Orocos KDL 1.5.1 (fk.csv beside each), and a reading by hand.
#include <fstream>
#include <sstream>

#include "tests/unit/urdf/motion.hpp"
#include "tests/unit/urdf/urdf_text.hpp"
#include "tests/unit/urdf/valid_mechanism.hpp"

namespace lf::urdf::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

struct Arm {
  std::string name, root, tool;
  std::size_t links, free;  // of the file, of the chain
};

void PrintTo(const Arm& arm, std::ostream* stream) { *stream << arm.name; }

class UrdfArms : public testing::TestWithParam<Arm> {
 protected:
  std::string folder() const { return LANTERNFISH_TEST_DATA "/arms/" + GetParam().name + "/"; }
  Reading read() const { return read_urdf(folder() + GetParam().name + ".urdf"); }
};

INSTANTIATE_TEST_SUITE_P(Files, UrdfArms,
                         testing::Values(Arm{"oberon7", "base", "tool", 12, 6}, Arm{"predator", "base", "tool", 11, 5},
                                         Arm{"ur5", "base_link", "tool0", 10, 6}, Arm{"panda", "panda_link0", "tool", 13, 7},
                                         Arm{"open_manipulator_x", "link1", "end_effector_link", 8, 4}),
                         [](const auto& test) { return test.param.name; });

TEST_P(UrdfArms, AreReadWhole) {
  const Mechanism arm = read().mechanism;
  EXPECT_EQ(fault_of(arm), "");
  EXPECT_EQ(arm.name, GetParam().name);
  EXPECT_EQ(arm.links[Mechanism::root].name, GetParam().root);
  EXPECT_EQ(arm.links.size(), GetParam().links);
  EXPECT_EQ(arm.free_joints(arm.path(Mechanism::root, arm.link(GetParam().tool))).size(), GetParam().free);
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

// The references have 12 digits after the point, and the two computations behind them agree to 5e-13.
TEST_P(UrdfArms, HaveTheToolWhereKdlHasIt) {
  const Mechanism arm = read().mechanism;
  const std::vector<Step> path = arm.path(Mechanism::root, arm.link(GetParam().tool));
  const std::vector<std::size_t> free = arm.free_joints(path);
  std::ifstream file(folder() + "fk.csv");
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  const std::vector<std::string> header = cells_of(line);
  ASSERT_EQ(header.size(), free.size() + 7);
  for (std::size_t i = 0; i < free.size(); ++i) EXPECT_EQ(header[i], arm.joints[free[i]].name);
  int rows = 0;
  for (; std::getline(file, line); ++rows) {
    std::vector<double> row;
    for (const std::string& cell : cells_of(line)) row.push_back(std::stod(cell));
    ASSERT_EQ(row.size(), header.size());
    const std::span<const double> q(row.data(), free.size());
    const double* const at = row.data() + free.size();
    const Pose tool = begin_from_end(arm, path, coordinates(arm, free, q));
    EXPECT_LT((tool.translation() - Vec3(at[0], at[1], at[2])).norm(), 3e-12) << "row " << rows;
    const Eigen::Quaterniond turn(at[6], at[3], at[4], at[5]);
    EXPECT_LT((tool.linear() - turn.normalized().toRotationMatrix()).norm(), 1e-11) << "row " << rows;
  }
  EXPECT_GE(rows, 4);
}

// The first attribute of an element in a text: a reader of its own, good for these files alone.
std::string attribute(const std::string& text, const std::string& element, const std::string& name) {
  const std::size_t begin = text.find("<" + element + " ");
  if (begin == std::string::npos) return "";
  const std::string tag = text.substr(begin, text.find('>', begin) - begin);
  const std::size_t at = tag.find(" " + name + "=\"");
  if (at == std::string::npos) return "";
  const std::size_t from = at + name.size() + 3;
  return tag.substr(from, tag.find('"', from) - from);
}

Vec3 three(const std::string& text, const Vec3& otherwise) {
  if (text.empty()) return otherwise;
  std::istringstream stream(text);
  Vec3 result;
  stream >> result[0] >> result[1] >> result[2];
  return result;
}

// The specification's rpy, element by element: fixed axes, roll first (wiki.ros.org/urdf/XML/joint; the product Rz Ry Rx written out).
Mat3 by_hand(const Vec3& rpy) {
  const double a = std::cos(rpy[2]), b = std::sin(rpy[2]), c = std::cos(rpy[1]), d = std::sin(rpy[1]), e = std::cos(rpy[0]),
               f = std::sin(rpy[0]);
  Mat3 r;
  r << a * c, a * d * f - b * e, a * d * e + b * f,  //
      b * c, b * d * f + a * e, b * d * e - a * f,   //
      -d, c * f, c * e;
  return r;
}

// A second reading of each joint, from the file's text and the specification alone.
TEST_P(UrdfArms, HaveJointsAsTheSpecificationSays) {
  const Mechanism arm = read().mechanism;
  std::ifstream file(folder() + GetParam().name + ".urdf");
  const std::string text = (std::stringstream() << file.rdbuf()).str();
  std::size_t seen = 0;
  for (std::size_t begin = text.find("<joint "); begin != std::string::npos; begin = text.find("<joint ", begin + 1), ++seen) {
    const std::string xml = text.substr(begin, text.find("</joint>", begin) - begin);
    const Joint& joint = arm.joints[arm.joint(attribute(xml, "joint", "name"))];
    EXPECT_EQ(arm.links[joint.parent].name, attribute(xml, "parent", "link")) << joint.name;
    EXPECT_EQ(arm.links[joint.child].name, attribute(xml, "child", "link")) << joint.name;
    EXPECT_EQ(joint.parent_from_joint.translation(), three(attribute(xml, "origin", "xyz"), Vec3::Zero())) << joint.name;
    EXPECT_LT((joint.parent_from_joint.linear() - by_hand(three(attribute(xml, "origin", "rpy"), Vec3::Zero()))).norm(), 1e-15)
        << joint.name;
    const std::string type = attribute(xml, "joint", "type"), lower = attribute(xml, "limit", "lower"),
                      upper = attribute(xml, "limit", "upper");
    const bool stands = type == "fixed" || (type == "revolute" && lower == upper);
    EXPECT_EQ(joint.moves(), !stands) << joint.name;
    if (stands) continue;
    EXPECT_EQ(joint.axis, three(attribute(xml, "axis", "xyz"), Vec3::UnitX())) << joint.name;
    EXPECT_EQ(joint.type, type == "continuous"  ? JointType::continuous
                          : type == "prismatic" ? JointType::prismatic
                                                : JointType::revolute)
        << joint.name;
    if (type == "continuous") continue;
    EXPECT_EQ(joint.range->lower, std::stod(lower)) << joint.name;
    EXPECT_EQ(joint.range->upper, std::stod(upper)) << joint.name;
    const double effort = std::stod(attribute(xml, "limit", "effort")), velocity = std::stod(attribute(xml, "limit", "velocity"));
    EXPECT_EQ(joint.effort, effort == 0 || effort == 1000 ? std::nullopt : std::optional(effort)) << joint.name;
    EXPECT_EQ(joint.velocity, velocity == 0 ? std::nullopt : std::optional(velocity)) << joint.name;
  }
  EXPECT_EQ(seen, arm.joints.size());
}

// The masses that their READMEs give or that add up by hand.
TEST(UrdfArm, MassesAreKept) {
  const auto mass_kg = [](const std::string& name) {
    double sum_kg = 0;
    for (const Link& link : read_urdf(LANTERNFISH_TEST_DATA "/arms/" + name + "/" + name + ".urdf").mechanism.links)
      if (link.inertial) sum_kg += link.inertial->mass_kg;
    return sum_kg;
  };
  EXPECT_NEAR(mass_kg("predator"), 55.4, 0.05);
  EXPECT_NEAR(mass_kg("ur5"), 4.0 + 3.7 + 8.393 + 2.33 + 1.219 + 1.219 + 0.1879, 1e-12);
}

TEST(UrdfArm, TellsOfEachWhatItsReadmeWarnsOf) {
  const auto notes = [](const std::string& name) {
    std::vector<std::string> texts;
    const Reading reading = read_urdf(LANTERNFISH_TEST_DATA "/arms/" + name + "/" + name + ".urdf");
    for (const Note& note : reading.notes) texts.push_back(note.text);
    return texts;
  };
  EXPECT_THAT(notes("panda"), Contains("<limit> of joint 'panda_joint4' does not hold 0: the joint cannot stand there"));
  EXPECT_THAT(notes("predator"), Contains("<limit> of joint 'finger_tip_left_joint' has lower = upper: the joint is taken as fixed there"));
  EXPECT_THAT(notes("open_manipulator_x"), Contains(HasSubstr("'joint1' has effort 1000")));
  EXPECT_THAT(notes("ur5"), Not(Contains(HasSubstr("right angle")))) << "its ten digits are good to 2e-10 rad";
}

// The arm that ships is of this project's own making: all of it is used.
TEST(UrdfArm, OfTheProjectIsReadWithItsOwnElements) {
  const Reading reading = read_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf");
  const Mechanism& arm = reading.mechanism;
  EXPECT_EQ(fault_of(arm), "");
  ASSERT_EQ(reading.notes.size(), 1u);
  EXPECT_EQ(reading.notes[0].text, "link 'tool' has no inertial: it has no mass");
  std::vector<std::string> elements;
  for (const Extension& extension : arm.joints[arm.joint("slew")].extensions) elements.push_back(extension.element);
  EXPECT_THAT(elements, testing::ElementsAre("drive", "friction", "screw"));
  EXPECT_EQ(arm.joints[arm.joint("slew")].extensions[0].number("rated_torque_nm"), 30);
  EXPECT_EQ(arm.driver(arm.joint("finger_b")).joint, arm.joint("jaw"));
}

// A stiffness may be left out, and is read where it stands.
TEST(UrdfArm, ThatTellsItsStiffnessIsRead) {
  for (const auto& [file, joint, stiffness] :
       {std::tuple{"oberon7/oberon7.urdf", "shoulder", 9000.0}, {"ur5/ur5.urdf", "wrist_1", 3000.0}}) {
    const Reading reading = read_urdf(std::string(LANTERNFISH_SOURCE_DIR "/shared/arm/") + file);
    const Mechanism& arm = reading.mechanism;
    EXPECT_EQ(fault_of(arm), "") << file;
    EXPECT_EQ(arm.joints[arm.joint(joint)].extensions[0].number("stiffness_nm_rad"), stiffness) << file;
  }
}

}  // namespace
}  // namespace lf::urdf::test
