// The tree: its order, the ways in it, and how its links move.
#include "tests/unit/urdf/motion.hpp"
#include "tests/unit/urdf/urdf_text.hpp"
#include "tests/unit/urdf/valid_mechanism.hpp"

namespace lf::urdf::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// The file's order is not the tree's: root -> (left -> tip), root -> right.
Mechanism tree() {
  const auto joint = [](const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                        const std::string& rest) {
    return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + child + "\"/>" + rest +
           "</joint>\n";
  };
  const std::string slide = "<axis xyz=\"0 1 0\"/><limit lower=\"0\" upper=\"4\" effort=\"1\" velocity=\"1\"/>";
  return read_text("<robot name=\"r\"><link name=\"tip\"/><link name=\"right\"/><link name=\"left\"/><link name=\"root\"/>" +
                   joint("lt", "continuous", "left", "tip", "<origin xyz=\"1 0 0\"/><axis xyz=\"0 0 1\"/>") +
                   joint("rl", "prismatic", "root", "left", "<origin xyz=\"0 0 1\" rpy=\"0 0 1.5707963267948966\"/>" + slide) +
                   joint("rr", "continuous", "root", "right", "<origin xyz=\"0 0 2\"/><axis xyz=\"1 0 0\"/>") + "</robot>");
}

TEST(Mechanism, HasItsRootFirstAndEachJointBeforeItsLink) {
  const Mechanism mechanism = tree();
  std::vector<std::string> names;
  for (const Link& link : mechanism.links) names.push_back(link.name);
  for (std::size_t i = 0; i < mechanism.joints.size(); ++i) {
    EXPECT_EQ(mechanism.joints[i].child, i + 1);
    EXPECT_LT(mechanism.joints[i].parent, mechanism.joints[i].child);
    EXPECT_EQ(mechanism.joint_of(i + 1), i);
  }
  EXPECT_FALSE(mechanism.joint_of(Mechanism::root).has_value());
  EXPECT_EQ(names[0], "root");
  EXPECT_EQ(mechanism.links[mechanism.joints[mechanism.joint("lt")].parent].name, "left");
}

TEST(Mechanism, ChildrenComeInTheOrderOfTheirJoints) {
  const Mechanism mechanism = tree();
  EXPECT_EQ(mechanism.link("left"), 1u);
  EXPECT_EQ(mechanism.link("tip"), 2u);
  EXPECT_EQ(mechanism.link("right"), 3u);
}

// The judge of the mutated and fuzzed files tells what is not as the header says.
TEST(ValidMechanism, TellsAnotherOrderAndBrokenExtensions) {
  EXPECT_EQ(fault_of(tree()), "");
  Mechanism exchanged = tree();
  std::swap(exchanged.joints[0].line, exchanged.joints[2].line);
  EXPECT_EQ(fault_of(exchanged), "children come in the order of their joints in the file");
  Mechanism broad = tree();  // root, left, right, tip
  std::swap(broad.links[2], broad.links[3]);
  std::swap(broad.joints[1], broad.joints[2]);
  broad.joints[1].child = 2, broad.joints[2].child = 3;
  EXPECT_EQ(fault_of(broad), "links come depth first");
  const Extension good{"gear", 7, {{"rad_per_count", 0.1}}};
  const auto with_extensions = [](const std::vector<Extension>& extensions) {
    Mechanism mechanism = tree();
    mechanism.joints[1].extensions = extensions;
    return fault_of(mechanism);
  };
  EXPECT_EQ(with_extensions({good}), "");
  EXPECT_EQ(with_extensions({good, good}), "an extension comes once");
  EXPECT_EQ(with_extensions({{"gear", 0, good.numbers}}), "an extension has a name and a line");
  EXPECT_EQ(with_extensions({{"gear", 7, {}}}), "an extension holds numbers");
  EXPECT_EQ(with_extensions({{"gear", 7, {{"rad_per_count", std::nan("")}}}}),
            "an extension's numbers are finite, each under a key of its own");
  Mechanism shape = read_text(body);
  shape.links[0].collisions[0].extensions = {good, good};
  EXPECT_EQ(fault_of(shape), "an extension comes once");
}

TEST(Mechanism, FindsTheWayBetweenAnyTwoLinks) {
  const Mechanism m = tree();
  const std::size_t lt = m.joint("lt"), rl = m.joint("rl"), rr = m.joint("rr");
  EXPECT_THAT(m.path(m.link("tip"), m.link("right")), ElementsAre(Step{lt, false}, Step{rl, false}, Step{rr, true}));
  EXPECT_THAT(m.path(m.link("right"), m.link("tip")), ElementsAre(Step{rr, false}, Step{rl, true}, Step{lt, true}));
  EXPECT_THAT(m.path(m.link("left"), m.link("tip")), ElementsAre(Step{lt, true}));
  EXPECT_THAT(m.path(m.link("tip"), m.link("tip")), IsEmpty());
}

TEST(Mechanism, PosesAreThoseOfThePaper) {
  const Mechanism m = tree();
  // The slide is turned by a quarter: its y is the root's -x. At 3 m left stands at (-3, 0, 1), and the tip's hinge, 1 m along left's x, at (-3, 1, 1).
  std::vector<double> q(3, 0.0);
  q[m.joint("rl")] = 3;
  q[m.joint("lt")] = pi / 2;
  const Pose tip = begin_from_end(m, m.path(0, m.link("tip")), q);
  EXPECT_LT((tip.translation() - Vec3(-3, 1, 1)).norm(), 1e-15);
  EXPECT_LT((tip.linear().col(0) + Vec3::UnitX()).norm(), 1e-15) << "two quarter turns";
  // The way back is the inverse, also through the root.
  const Pose there = begin_from_end(m, m.path(m.link("tip"), m.link("right")), q),
             back = begin_from_end(m, m.path(m.link("right"), m.link("tip")), q);
  EXPECT_LT((there.matrix() * back.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-14);
}

// Against differences of the pose, on ways outward, inward and through the root, with mimics.
TEST(Mechanism, JacobiansAreTheDerivativesOfPoses) {
  const std::string arms = LANTERNFISH_TEST_DATA "/arms/";
  struct Case {
    Mechanism mechanism;
    std::string from, to;
  };
  const std::vector<Case> cases{
      {tree(), "tip", "right"},
      {tree(), "root", "tip"},
      {read_urdf(arms + "panda/panda.urdf").mechanism, "panda_link0", "tool"},
      {read_urdf(arms + "oberon7/oberon7.urdf").mechanism, "tool", "base"},
      {read_urdf(arms + "open_manipulator_x/open_manipulator_x.urdf").mechanism, "gripper_right_link", "gripper_left_link"}};
  for (const Case& c : cases) {
    const Mechanism& m = c.mechanism;
    const std::vector<Step> path = m.path(m.link(c.from), m.link(c.to));
    const std::vector<std::size_t> free = m.free_joints(path);
    std::vector<double> q;
    for (std::size_t i = 0; i < free.size(); ++i)
      q.push_back(m.joints[free[i]].range ? m.joints[free[i]].range->middle() + 0.003 * static_cast<double>(i + 1) : 0.7);
    const auto j = jacobian(m, path, coordinates(m, free, q));
    ASSERT_EQ(j.cols(), static_cast<Eigen::Index>(free.size()));
    const Mat3 r = begin_from_end(m, path, coordinates(m, free, q)).linear();
    constexpr double h = 1e-6;
    for (std::size_t i = 0; i < free.size(); ++i) {
      std::vector<double> above = q, below = q;
      above[i] += h;
      below[i] -= h;
      const Pose a = begin_from_end(m, path, coordinates(m, free, above)), b = begin_from_end(m, path, coordinates(m, free, below));
      const Mat3 spin = (a.linear() - b.linear()) / (2 * h) * r.transpose();
      Eigen::Matrix<double, 6, 1> by_difference;
      by_difference << (a.translation() - b.translation()) / (2 * h), spin(2, 1), spin(0, 2), spin(1, 0);
      EXPECT_LT((j.col(static_cast<Eigen::Index>(i)) - by_difference).norm(), 1e-8)
          << c.from << " to " << c.to << ", joint " << m.joints[free[i]].name;
    }
  }
}

TEST(Mechanism, NamesThatAreNotThereAreRefusedWithThoseThatAre) {
  const Mechanism m = tree();
  EXPECT_EQ(m.find_link("nobody"), std::nullopt);
  EXPECT_EQ(m.find_joint("left"), std::nullopt) << "a link";
  EXPECT_EQ(lf::test::message_of<InputError>([&] { (void)m.joint("nobody"); }), m.file + ": has no joint 'nobody'; it has rl, lt, rr");
  EXPECT_EQ(lf::test::message_of<InputError>([&] { (void)m.link("nobody"); }),
            m.file + ": has no link 'nobody'; it has root, left, tip, right");
}

}  // namespace
}  // namespace lf::urdf::test
