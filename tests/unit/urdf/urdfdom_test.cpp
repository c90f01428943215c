// The referee: Debian's urdfdom, which ROS reads URDF with. It is permissive, so each file is compared in what both have, and a table says where they differ and why.
#include "tests/unit/urdf/urdf_text.hpp"

#ifdef LANTERNFISH_HAS_URDFDOM
#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <fstream>
#include <sstream>
#endif

namespace lf::urdf::test {
namespace {

#ifndef LANTERNFISH_HAS_URDFDOM

TEST(UrdfReferee, Urdfdom) { GTEST_SKIP() << "missing: apt-get install liburdfdom-dev"; }

#else

Vec3 vec(const ::urdf::Vector3& v) { return {v.x, v.y, v.z}; }

// Their rotations are quaternions, so the last digits differ.
void expect_same(const Pose& ours, const ::urdf::Pose& theirs, const std::string& what) {
  EXPECT_EQ(ours.translation(), vec(theirs.position)) << what;
  const Eigen::Quaterniond turn(theirs.rotation.w, theirs.rotation.x, theirs.rotation.y, theirs.rotation.z);
  EXPECT_LT((ours.linear() - turn.toRotationMatrix()).norm(), 4e-15) << what;
}

void expect_same(const Geometry& ours, const ::urdf::Geometry& theirs, const std::string& what) {
  if (const auto* box = std::get_if<Box>(&ours)) {
    ASSERT_EQ(theirs.type, ::urdf::Geometry::BOX) << what;
    EXPECT_EQ(box->size_m, vec(static_cast<const ::urdf::Box&>(theirs).dim)) << what;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&ours)) {
    ASSERT_EQ(theirs.type, ::urdf::Geometry::CYLINDER) << what;
    EXPECT_EQ(cylinder->radius_m, static_cast<const ::urdf::Cylinder&>(theirs).radius) << what;
    EXPECT_EQ(cylinder->length_m, static_cast<const ::urdf::Cylinder&>(theirs).length) << what;
  } else {
    ASSERT_TRUE(std::holds_alternative<Sphere>(ours) && theirs.type == ::urdf::Geometry::SPHERE) << what;
    EXPECT_EQ(std::get<Sphere>(ours).radius_m, static_cast<const ::urdf::Sphere&>(theirs).radius) << what;
  }
}

void expect_same(const Link& ours, const ::urdf::Link& theirs) {
  ASSERT_EQ(ours.inertial.has_value(), theirs.inertial != nullptr) << ours.name;
  if (ours.inertial) {
    const ::urdf::Inertial& i = *theirs.inertial;
    EXPECT_EQ(ours.inertial->mass_kg, i.mass) << ours.name;
    expect_same(ours.inertial->link_from_com, i.origin, ours.name);
    Mat3 inertia;
    inertia << i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz;
    EXPECT_EQ(ours.inertial->inertia_kg_m2, inertia) << ours.name;
  }
  ASSERT_EQ(ours.collisions.size(), theirs.collision_array.size()) << ours.name;
  for (std::size_t i = 0; i < ours.collisions.size(); ++i) {
    expect_same(ours.collisions[i].link_from_shape, theirs.collision_array[i]->origin, ours.name);
    expect_same(ours.collisions[i].geometry, *theirs.collision_array[i]->geometry, ours.name);
  }
  ASSERT_EQ(ours.visuals.size(), theirs.visual_array.size()) << ours.name;
  for (std::size_t i = 0; i < ours.visuals.size(); ++i) {
    const ::urdf::Visual& visual = *theirs.visual_array[i];
    expect_same(ours.visuals[i].link_from_shape, visual.origin, ours.name);
    expect_same(ours.visuals[i].geometry, *visual.geometry, ours.name);
    ASSERT_EQ(ours.visuals[i].rgba.has_value(), visual.material != nullptr) << ours.name;
    if (!visual.material) continue;
    const ::urdf::Color& color = visual.material->color;
    EXPECT_EQ(*ours.visuals[i].rgba, (std::array<float, 4>{color.r, color.g, color.b, color.a})) << ours.name;
  }
}

void expect_same_rating(std::optional<double> ours, double theirs, const std::string& what) {
  if (ours)
    EXPECT_EQ(*ours, theirs) << what;
  else
    EXPECT_TRUE(theirs == 0 || theirs == 1000) << what;
}

void expect_same(const Mechanism& mechanism, const Joint& ours, const ::urdf::Joint& theirs) {
  EXPECT_EQ(mechanism.links[ours.parent].name, theirs.parent_link_name) << ours.name;
  EXPECT_EQ(mechanism.links[ours.child].name, theirs.child_link_name) << ours.name;
  expect_same(ours.parent_from_joint, theirs.parent_to_joint_origin_transform, ours.name);
  // A range of no width is theirs to turn in, and at 0 in all of these files.
  if (theirs.type == ::urdf::Joint::REVOLUTE && theirs.limits->lower == 0 && theirs.limits->upper == 0) {
    EXPECT_EQ(ours.type, JointType::fixed) << ours.name;
    return;
  }
  const auto type = ours.type == JointType::revolute     ? ::urdf::Joint::REVOLUTE
                    : ours.type == JointType::continuous ? ::urdf::Joint::CONTINUOUS
                    : ours.type == JointType::prismatic  ? ::urdf::Joint::PRISMATIC
                                                         : ::urdf::Joint::FIXED;
  ASSERT_EQ(type, theirs.type) << ours.name;
  if (!ours.moves()) return;
  EXPECT_EQ(ours.axis, vec(theirs.axis)) << ours.name;
  if (ours.range) {
    EXPECT_EQ(ours.range->lower, theirs.limits->lower) << ours.name;
    EXPECT_EQ(ours.range->upper, theirs.limits->upper) << ours.name;
    expect_same_rating(ours.effort, theirs.limits->effort, ours.name);
    expect_same_rating(ours.velocity, theirs.limits->velocity, ours.name);
  }
  EXPECT_EQ(ours.dynamics.damping, theirs.dynamics ? theirs.dynamics->damping : 0) << ours.name;
  EXPECT_EQ(ours.dynamics.friction, theirs.dynamics ? theirs.dynamics->friction : 0) << ours.name;
  ASSERT_EQ(ours.mimic.has_value(), theirs.mimic != nullptr) << ours.name;
  if (!ours.mimic) return;
  EXPECT_EQ(mechanism.joints[ours.mimic->joint].name, theirs.mimic->joint_name) << ours.name;
  EXPECT_EQ(ours.mimic->multiplier, theirs.mimic->multiplier) << ours.name;
  EXPECT_EQ(ours.mimic->offset, theirs.mimic->offset) << ours.name;
}

class UrdfReferee : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Files, UrdfReferee,
                         testing::Values(LANTERNFISH_TEST_DATA "/arms/oberon7/oberon7.urdf",
                                         LANTERNFISH_TEST_DATA "/arms/predator/predator.urdf", LANTERNFISH_TEST_DATA "/arms/ur5/ur5.urdf",
                                         LANTERNFISH_TEST_DATA "/arms/panda/panda.urdf",
                                         LANTERNFISH_TEST_DATA "/arms/open_manipulator_x/open_manipulator_x.urdf",
                                         LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf"),
                         [](const auto& test) { return std::filesystem::path(test.param).stem().string(); });

TEST_P(UrdfReferee, UrdfdomReadsTheSame) {
  const Mechanism ours = read_urdf(GetParam()).mechanism;
  const auto theirs = ::urdf::parseURDFFile(GetParam());
  ASSERT_NE(theirs, nullptr);
  EXPECT_EQ(ours.name, theirs->name_);
  EXPECT_EQ(ours.links[Mechanism::root].name, theirs->root_link_->name);
  ASSERT_EQ(ours.links.size(), theirs->links_.size());
  ASSERT_EQ(ours.joints.size(), theirs->joints_.size());
  for (const Link& link : ours.links) {
    ASSERT_TRUE(theirs->links_.contains(link.name)) << link.name;
    expect_same(link, *theirs->links_.at(link.name));
  }
  for (const Joint& joint : ours.joints) {
    ASSERT_TRUE(theirs->joints_.contains(joint.name)) << joint.name;
    expect_same(ours, joint, *theirs->joints_.at(joint.name));
  }
}

bool they_read(const std::string& text) { return ::urdf::parseURDF(text) != nullptr; }

class UrdfdomDiffers : public testing::Test {
 protected:
  void SetUp() override { console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE); }
};

// What it takes without a word and this reader refuses.
TEST_F(UrdfdomDiffers, InTakingWhatCannotBe) {
  const std::vector<std::pair<std::string, std::string> > texts{
      {"a misspelt key: the upper limit is then 0", with(elbow, "upper=\"2\"", "uper=\"2\"")},
      {"limits upside down", with(elbow, "lower=\"-1\" upper=\"2\"", "lower=\"2\" upper=\"-1\"")},
      {"a negative effort", with(elbow, "effort=\"3\"", "effort=\"-3\"")},
      {"an axis of length 0", with(elbow, "xyz=\"0 0 1\"", "xyz=\"0 0 0\"")},
      {"a mimic of nothing", with(elbow, "</joint>", "<mimic joint=\"jaw\"/></joint>")},
      {"a mimic of itself", with(elbow, "</joint>", "<mimic joint=\"elbow\"/></joint>")},
      {"an inertia of no body", with(body, "izz=\"4\"", "izz=\"40\"")},
      {"a negative mass", with(body, "value=\"2\"", "value=\"-2\"")},
      {"a size below 0", with(body, "radius=\"1\"", "radius=\"-1\"")},
      {"an undefined material", with(body, "<visual>", "<visual><material name=\"red\"/>")},
      {"an element nobody knows", with(elbow, "<axis", "<axes/><axis")},
  };
  for (const auto& [what, text] : texts) {
    EXPECT_TRUE(they_read(text)) << what;
    EXPECT_NE(error_of(text), "") << what;
  }
}

// What both refuse.
TEST_F(UrdfdomDiffers, InNothingOfThese) {
  const std::vector<std::pair<std::string, std::string> > texts{
      {"a second root", and_also(elbow, "<link name=\"loose\"/>")},
      {"an unknown parent", with(elbow, "<parent link=\"base\"/>", "<parent link=\"bas\"/>")},
      {"a link twice", and_also(elbow, "<link name=\"arm\"/>")},
      {"an unknown type", with(elbow, "revolute", "hinge")},
      {"no limit", with(elbow, "<limit lower=\"-1\" upper=\"2\" effort=\"3\" velocity=\"4\"/>", "")},
      {"no effort", with(elbow, "effort=\"3\"", "")},
      {"two numbers for a vector", with(elbow, "xyz=\"1 2 3\"", "xyz=\"1 2\"")},
      {"a file cut off", elbow.substr(0, 200)},
  };
  for (const auto& [what, text] : texts) {
    EXPECT_FALSE(they_read(text)) << what;
    EXPECT_NE(error_of(text), "") << what;
  }
}

// The specification: "the vector should be normalized". Theirs is left as it is, ours points the same way and has length 1.
TEST_F(UrdfdomDiffers, InTheLengthOfAnAxis) {
  const std::string text = with(elbow, "xyz=\"0 0 1\"", "xyz=\"0 3 4\"");
  const Vec3 theirs = vec(::urdf::parseURDF(text)->joints_.at("elbow")->axis);
  EXPECT_EQ(theirs, Vec3(0, 3, 4));
  EXPECT_LT((read_text(text).joints[0].axis - theirs.normalized()).norm(), 1e-15);
}

TEST_F(UrdfdomDiffers, InNothingAboutASecondOrigin) {
  const std::string text = with(elbow, "<axis", "<origin xyz=\"7 7 7\"/><axis");
  EXPECT_EQ(vec(::urdf::parseURDF(text)->joints_.at("elbow")->parent_to_joint_origin_transform.position),
            read_text(text).joints[0].parent_from_joint.translation());
}

#endif

}  // namespace
}  // namespace lf::urdf::test
