// What is refused, with its line and the remedy.
#include <locale>
#include <sstream>

#include "tests/unit/urdf/urdf_text.hpp"

namespace lf::urdf::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Refused {
  std::string what;  // in the text of `elbow` or `body`
  std::string replacement;
  std::string error;  // begins so
};

void expect_refused(const std::string& base, const std::vector<Refused>& cases) {
  for (const Refused& c : cases) {
    const std::string error = error_of(with(base, c.what, c.replacement));
    EXPECT_THAT(error, StartsWith(c.error)) << c.replacement;
    EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 0) << error;
  }
}

TEST(UrdfRefuses, JointsThatAreNoneOfOurs) {
  expect_refused(
      elbow,
      {{"revolute", "floating", "arm.urdf:4: joint 'elbow' is floating: a base that moves is placed by what uses the mechanism."},
       {"revolute", "planar", "arm.urdf:4: joint 'elbow' is planar: write two prismatic joints and a revolute one"},
       {"revolute", "hinge", "arm.urdf:4: joint 'elbow' has an unknown type 'hinge': write revolute, continuous, prismatic or fixed"},
       {" type=\"revolute\"", "", "arm.urdf:4: joint 'elbow' has no type: write revolute, continuous, prismatic or fixed"},
       {"name=\"elbow\"", "", "arm.urdf:4: <joint> has no name: give one"},
       {"name=\"elbow\"", "name=\"\"", "arm.urdf:4: joint '' has no name: give one"}});
}

TEST(UrdfRefuses, ASecondRobot) {
  EXPECT_THAT(error_of(elbow + elbow), StartsWith("arm.urdf:12: a second element stands beside <robot>: write one robot a file"));
}

TEST(UrdfRefuses, LinksThatAreNotThere) {
  expect_refused(elbow,
                 {{"<parent link=\"base\"/>", "<parent link=\"bas\"/>",
                   "arm.urdf:5: joint 'elbow' has the parent 'bas', which is no link of this file: correct the name, or add the link"},
                  {"<child link=\"arm\"/>", "<child link=\"elbow\"/>",
                   "arm.urdf:6: joint 'elbow' has the child 'elbow', which is no link of this file"},
                  {"<parent link=\"base\"/>", "", "arm.urdf:4: joint 'elbow' has no <parent>: name the link"},
                  {"<child link=\"arm\"/>", "<child/>", "arm.urdf:6: <child> of joint 'elbow' has no link: give one"},
                  {"<robot name=\"r\">", "<robot>", "arm.urdf:1: <robot> has no name: give one"}});
}

TEST(UrdfRefuses, WhatIsThereTwice) {
  EXPECT_EQ(error_of(and_also(elbow, "<link name=\"arm\"/>")), "arm.urdf:11: link 'arm' is there twice: rename one");
  const std::string twin =
      and_also(elbow, "<link name=\"x\"/>\n<joint name=\"elbow\" type=\"fixed\"><parent link=\"arm\"/><child link=\"x\"/></joint>");
  EXPECT_EQ(error_of(twin), "arm.urdf:12: joint 'elbow' is there twice: rename one");
  expect_refused(elbow, {{"<axis", "<axis xyz=\"1 0 0\"/><axis", "arm.urdf:8: <axis> of joint 'elbow' comes a second time: remove one"},
                         {"lower=\"-1\"", "lower=\"-1\" lower=\"0\"",
                          "arm.urdf:9: is not well-formed XML: an attribute is there twice, or lacks its = or a quote; correct it"}});
  expect_refused(body, {{"<mass value=\"2\"/>", "<mass value=\"2\"/><mass value=\"2\"/>",
                         "arm.urdf:5: <mass> of link 'base' comes a second time: remove one"},
                        {"<box size=\"1 2 3\"/>", "<box size=\"1 2 3\"/><sphere radius=\"1\"/>",
                         "arm.urdf:9: <geometry> of link 'base' has to hold one shape, and holds 2"}});
}

TEST(UrdfRefuses, WhatIsNoTree) {
  const auto fixed = [](const char* name, const char* parent, const char* child) {
    return std::string("<joint name=\"") + name + "\" type=\"fixed\"><parent link=\"" + parent + "\"/><child link=\"" + child +
           "\"/></joint>\n";
  };
  EXPECT_EQ(error_of(and_also(elbow, "<link name=\"loose\"/>")),
            "arm.urdf:11: link 'loose' is a second root beside 'base': no joint carries it. Join it to the tree, or remove it");
  EXPECT_EQ(error_of(and_also(elbow, fixed("back", "arm", "base"))),
            "arm.urdf:11: joint 'back' closes a ring of joints through link 'base': a mechanism is a tree, remove one joint of the ring")
      << "no root";
  EXPECT_EQ(error_of(and_also(elbow, "<link name=\"p\"/><link name=\"q\"/>\n" + fixed("pq", "p", "q") + fixed("qp", "q", "p"))),
            "arm.urdf:13: joint 'qp' closes a ring of joints through link 'p': a mechanism is a tree, remove one joint of the ring")
      << "beside a root";
  EXPECT_EQ(error_of(with(elbow, "<child link=\"arm\"/>", "<child link=\"base\"/>")),
            "arm.urdf:4: joint 'elbow' closes a ring of joints through link 'base': a mechanism is a tree, remove one joint of the ring");
  EXPECT_EQ(
      error_of(and_also(elbow, fixed("other", "base", "arm"))),
      "arm.urdf:11: joint 'other' carries link 'arm', which joint 'elbow' carries, too: a mechanism is a tree, remove one of the two");
  EXPECT_EQ(error_of("<robot name=\"r\"/>"), "arm.urdf: has no link: write one");
}

TEST(UrdfRefuses, AJointFromALinkToItself) {
  EXPECT_EQ(
      error_of(
          "<robot name=\"r\"><link name=\"a\"/>\n<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"a\"/></joint></robot>"),
      "arm.urdf:2: joint 'j' closes a ring of joints through link 'a': a mechanism is a tree, remove one joint of the ring");
}

TEST(UrdfRefuses, MimicsThatLeadNowhere) {
  const auto mimic = [](const std::string& of) { return with(elbow, "</joint>", "<mimic joint=\"" + of + "\"/></joint>"); };
  EXPECT_EQ(error_of(mimic("jaw")), "arm.urdf:10: joint 'elbow' mimics 'jaw', which is not there: name a joint of this file");
  EXPECT_EQ(error_of(mimic("elbow")), "arm.urdf:10: joint 'elbow' mimics itself: remove one <mimic>");
  const std::string rest =
      "<link name=\"x\"/>\n<joint name=\"j\" type=\"TYPE\"><parent link=\"arm\"/><child link=\"x\"/><axis xyz=\"0 0 1\"/>REST</joint>\n";
  EXPECT_EQ(error_of(and_also(mimic("j"), with(with(rest, "TYPE", "fixed"), "<axis xyz=\"0 0 1\"/>REST", ""))),
            "arm.urdf:10: joint 'elbow' mimics 'j', which is fixed: make this joint fixed, too");
  const std::string still = with(with(rest, "TYPE", "revolute"), "REST", "<limit lower=\"1\" upper=\"1\" effort=\"0\" velocity=\"0\"/>");
  EXPECT_EQ(error_of(and_also(mimic("j"), still)),
            "arm.urdf:10: joint 'elbow' mimics 'j', whose range has no width: make this joint fixed, too");
  const std::string ring = with(with(rest, "TYPE", "continuous"), "REST", "<mimic joint=\"elbow\"/>");
  EXPECT_EQ(error_of(and_also(mimic("j"), ring)),
            "arm.urdf:10: joint 'elbow' mimics itself through others: remove one <mimic>\narm.urdf:12: joint 'j' mimics itself through "
            "others: remove one <mimic>");
  EXPECT_THAT(error_of(with(mimic("elbow"), "joint=\"elbow\"/>", "joint=\"elbow\" multiplier=\"0\"/>")),
              StartsWith("arm.urdf:10: <mimic> of joint 'elbow' has a multiplier of 0"));
}

TEST(UrdfRefuses, NumbersThatAreNone) {
  expect_refused(
      elbow,
      {{"upper=\"2\"", "upper=\"nan\"", "arm.urdf:9: <limit> of joint 'elbow' upper='nan': 'nan' is no number; it has to be finite"},
       {"upper=\"2\"", "upper=\"-inf\"", "arm.urdf:9: <limit> of joint 'elbow' upper='-inf': '-inf' is no number; it has to be finite"},
       {"upper=\"2\"", "upper=\"1e999\"", "arm.urdf:9: <limit> of joint 'elbow' upper='1e999': '1e999' is no number"},
       {"upper=\"2\"", "upper=\"2,5\"", "arm.urdf:9: <limit> of joint 'elbow' upper='2,5': '2,5' is no number; write a decimal point"},
       {"upper=\"2\"", "upper=\"2.5f\"", "arm.urdf:9: <limit> of joint 'elbow' upper='2.5f': '2.5f' is no number"},
       {"upper=\"2\"", "upper=\"0x10\"", "arm.urdf:9: <limit> of joint 'elbow' upper='0x10': '0x10' is no number"},
       {"upper=\"2\"", "upper=\"2 3\"", "arm.urdf:9: <limit> of joint 'elbow' upper='2 3' has to be one number"},
       {"upper=\"2\"", "upper=\"\"", "arm.urdf:9: <limit> of joint 'elbow' upper='' has to be one number"},
       {"upper=\"2\"", "upper=\"+-2\"", "arm.urdf:9: <limit> of joint 'elbow' upper='+-2': '+-2' is no number"},
       {"xyz=\"1 2 3\"", "xyz=\"1 2\"", "arm.urdf:7: <origin> of joint 'elbow' xyz='1 2' has to be 3 numbers"},
       {"xyz=\"1 2 3\"", "xyz=\"1 2 3 4\"", "arm.urdf:7: <origin> of joint 'elbow' xyz='1 2 3 4' has to be 3 numbers"},
       {"xyz=\"1 2 3\"", "xyz=\"1, 2, 3\"",
        "arm.urdf:7: <origin> of joint 'elbow' xyz='1, 2, 3': '1,' is no number; write a decimal point, and spaces between numbers"}});
}

TEST(UrdfRefuses, NumbersThatCannotBe) {
  expect_refused(
      elbow,
      {{"upper=\"2\"", "upper=\"1e16\"",
        "arm.urdf:9: <limit> of joint 'elbow' upper='1e16': it has to be from -1000 to 1000; make a joint without ends continuous"},
       {"effort=\"3\"", "effort=\"-3\"",
        "arm.urdf:9: <limit> of joint 'elbow' effort='-3': it has to be from 0 to 1e+09; write 0 where it is not known"},
       {"effort=\"3\"", "", "arm.urdf:9: <limit> of joint 'elbow' has no effort: give it"},
       {"velocity=\"4\"", "", "arm.urdf:9: <limit> of joint 'elbow' has no velocity: give it"},
       {"lower=\"-1\" upper=\"2\"", "",
        "arm.urdf:9: <limit> of joint 'elbow' has neither lower nor upper: give them in radians, or make the joint continuous"},
       {"xyz=\"1 2 3\"", "xyz=\"1 2 3000\"",
        "arm.urdf:7: <origin> of joint 'elbow' xyz='1 2 3000': it has to be from -1000 to 1000; URDF has metres; is it in millimetres?"},
       {"rpy=\"0 0 0\"", "rpy=\"0 0 1e5\"",
        "arm.urdf:7: <origin> of joint 'elbow' rpy='0 0 1e5': it has to be from -1000 to 1000; URDF has radians"},
       {"xyz=\"0 0 1\"", "xyz=\"0 0 0\"", "arm.urdf:8: <axis> of joint 'elbow' has length 0"},
       {"</joint>", "<dynamics damping=\"-1\"/></joint>", "arm.urdf:10: <dynamics> of joint 'elbow' damping='-1': it has to be from 0"}});
  expect_refused(body, {{"size=\"1 2 3\"", "size=\"1 0 3\"",
                         "arm.urdf:9: <box> of link 'base' size='1 0 3': it has to be from 1e-09 to 1000; URDF has metres, above 0"},
                        {"radius=\"1\"", "radius=\"-1\"", "arm.urdf:12: <cylinder> of link 'base' radius='-1': it has to be from 1e-09"},
                        {"radius=\"1\"", "", "arm.urdf:12: <cylinder> of link 'base' has no radius: give it"},
                        {"<mass value=\"2\"/>", "", "arm.urdf:3: <inertial> of link 'base' has no <mass>: give it, or remove the inertial"},
                        {"iyz=\"0\"", "", "arm.urdf:6: <inertia> of link 'base' has no iyz: give it"},
                        {"<box size=\"1 2 3\"/>", "", "arm.urdf:9: <geometry> of link 'base' has to hold one shape, and holds 0"},
                        {"<geometry><box size=\"1 2 3\"/></geometry>", "",
                         "arm.urdf:8: <visual> of link 'base' has no <geometry>: give it a box, cylinder, sphere or mesh"},
                        {"<box size=\"1 2 3\"/>", "<capsule radius=\"1\" length=\"2\"/>",
                         "arm.urdf:9: <geometry> of link 'base' holds a <capsule>, which is not URDF 1.0: write a <cylinder>"}});
}

TEST(UrdfRefuses, WhatIsUnknown) {
  expect_refused(
      elbow,
      {{"upper=\"2\"", "uper=\"2\"",
        "arm.urdf:9: <limit> of joint 'elbow' has an unknown attribute 'uper': it may have lower, upper, effort and velocity"},
       {"<axis", "<axes/><axis",
        "arm.urdf:8: <axes> of joint 'elbow' is not known here: <joint> may hold parent, child, origin, axis, limit, safety_controller, "
        "dynamics and mimic"},
       {"<link name=\"arm\"/>", "<link name=\"arm\"/><loop_joint name=\"l\"/>",
        "arm.urdf:3: <loop_joint> 'l' is not known here: <robot> may hold link, joint and material"},
       {"<robot name=\"r\">", "<robot name=\"r\" version=\"2.0\">", "arm.urdf:1: robot 'r' has version '2.0': this reader knows 1.0"}});
  expect_refused(body, {{"<box", "<geom/><box",
                         "arm.urdf:9: <geom> of link 'base' is not known here: <geometry> may hold box, cylinder, sphere and mesh"}});
}

TEST(UrdfRefuses, OwnElementsThatAreMisplacedOrIncomplete) {
  const auto in_joint = [](const std::string& element) { return with(elbow, "</joint>", element + "</joint>"); };
  EXPECT_THAT(error_of(in_joint("<lanternfish:wet_weight n=\"1\"/>")),
              StartsWith("arm.urdf:10: <lanternfish:wet_weight> of joint 'elbow' is not known in <joint>"));
  EXPECT_THAT(error_of(in_joint("<lanternfish:gear/>")),
              StartsWith("arm.urdf:10: <lanternfish:gear> of joint 'elbow' has no rad_per_count: give it"));
  EXPECT_THAT(error_of(in_joint("<lanternfish:gear rad_per_count=\"1\" x=\"2\"/>")),
              StartsWith("arm.urdf:10: <lanternfish:gear> of joint 'elbow' has an unknown attribute 'x': it may have rad_per_count"));
  EXPECT_THAT(error_of(in_joint("<lanternfish:gear rad_per_count=\"1\"/><lanternfish:gear rad_per_count=\"1\"/>")),
              StartsWith("arm.urdf:10: <lanternfish:gear> of joint 'elbow' comes a second time"));
}

TEST(UrdfRefuses, ColoursThatAreNone) {
  const auto coloured = [](const std::string& material) { return with(body, "<visual>", "<visual>" + material); };
  EXPECT_THAT(error_of(coloured("<material name=\"red\"/>")),
              StartsWith("arm.urdf:8: <material> 'red' of link 'base' is defined nowhere: define it below <robot>"));
  EXPECT_THAT(error_of(coloured("<material name=\"red\"><color rgba=\"255 0 0 1\"/></material>")),
              HasSubstr("rgba='255 0 0 1': it has to be from 0 to 1; divide by 255"));
  const std::string red = "<material name=\"m\"><color rgba=\"1 0 0 1\"/></material>",
                    blue = "<material name=\"m\"><color rgba=\"0 0 1 1\"/></material>";
  EXPECT_THAT(error_of(and_also(body, red + blue)),
              StartsWith("arm.urdf:15: <material> 'm' is defined twice, with two colours: remove one"));
  EXPECT_EQ(error_of(and_also(body, red + red)), "");
}

TEST(UrdfRefuses, AllProblemsOfAFileAtOnceInTheirOrder) {
  std::string text = with(elbow, "upper=\"2\"", "upper=\"x\"");
  text = with(text, "<parent link=\"base\"/>", "<parent link=\"bas\"/>");
  text = with(text, "xyz=\"0 0 1\"", "xyz=\"0 0 0\"");
  EXPECT_EQ(error_of(text),
            "arm.urdf:5: joint 'elbow' has the parent 'bas', which is no link of this file: correct the name, or add the link\n"
            "arm.urdf:8: <axis> of joint 'elbow' has length 0: write the direction about which the joint turns or along which it slides\n"
            "arm.urdf:9: <limit> of joint 'elbow' upper='x': 'x' is no number");
}

TEST(UrdfRefuses, FiftyProblemsInFullAndTheRestByNumber) {
  std::string links;
  for (int i = 0; i < 60; ++i) links += "<link name=\"l\" x=\"1\"/>\n";
  const std::string error = error_of("<robot name=\"r\">\n" + links + "</robot>");
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 50);
  EXPECT_THAT(error, HasSubstr("\narm.urdf: and 69 more problems"));  // 60 attributes, 59 names that are there twice
}

TEST(UrdfRefuses, FilesThatAreCutOff) {
  for (std::size_t length = 1; length + 2 < elbow.size(); length += 7) {
    const std::string error = error_of(elbow.substr(0, length));
    EXPECT_THAT(error, StartsWith("arm.urdf:")) << length;
    EXPECT_TRUE(length <= 20 || error.find("is not well-formed XML: it has no </robot>; was it cut off?") != std::string::npos)
        << length << error;
  }
}

TEST(UrdfRefuses, FilesThatAreNone) {
  EXPECT_EQ(error_of(""), "arm.urdf: is empty: write a <robot>");
  EXPECT_EQ(error_of("<!-- nothing -->"), "arm.urdf: has no element: write a <robot>");
  EXPECT_EQ(error_of("\n<sdf/>"), "arm.urdf:2: begins with <sdf>, not with <robot>: is it a URDF?");
  EXPECT_EQ(error_of(std::string("<robot\n\0/>", 10)), "arm.urdf:2: holds a byte 0: save it as UTF-8 text");
  EXPECT_THAT(error_of("<robot name=\"r\"><link name=\"a\"></robot>"),
              StartsWith("arm.urdf:1: is not well-formed XML (XML_ERROR_MISMATCHED_ELEMENT): correct it"));
  const lf::test::TemporaryFolder folder;
  EXPECT_EQ(lf::test::message_of<InputError>([&] { read_urdf(folder / "arm.urdf"); }), folder / "arm.urdf" + ": there is no such file");
  EXPECT_EQ(lf::test::message_of<InputError>([&] { read_urdf(folder.path().string()); }),
            folder.path().string() + ": is a folder, not a file");
  EXPECT_EQ(lf::test::message_of<InputError>([&] { read_urdf("/dev/zero"); }), "/dev/zero: is no regular file: copy it into one");
}

TEST(UrdfRefuses, FilesOfAbsurdSizeOrDepth) {
  EXPECT_EQ(error_of("<robot name=\"r\">" + std::string(std::size_t{16} << 20, ' ') + "</robot>"),
            "arm.urdf: has more than 16 MB: is it a URDF? Meshes belong into files of their own");
  std::string deep = "<robot name=\"r\">";
  for (int i = 0; i < 100000; ++i) deep += "<link>";
  EXPECT_EQ(error_of(deep), "arm.urdf:1: has elements more than 100 deep: links and joints stand side by side below <robot>");
  std::string many = "<robot name=\"r\">";
  for (int i = 0; i <= 4096; ++i) many += "<link name=\"l" + std::to_string(i) + "\"/>";
  EXPECT_EQ(error_of(many + "</robot>"), "arm.urdf: has 4097 links and 0 joints; 4096 of each are read: is it one mechanism?");
  std::string noisy = "<robot name=\"r\"><link name=\"a\"/>";
  for (int i = 0; i < 10001; ++i) noisy += "<gazebo/>";
  EXPECT_EQ(error_of(noisy + "</robot>"), "arm.urdf:1: is the 10000th remark on this file: is it a URDF?");
}

// A chain of as many links as are read: nothing in the reader recurses, and nothing takes the square of the time.
TEST(UrdfReads, AChainOfFourThousandLinks) {
  std::string text = "<robot name=\"r\"><link name=\"l0\"/>";
  for (int i = 1; i < 4096; ++i) {
    const std::string n = std::to_string(i);
    text += "<link name=\"l" + n + "\"/><joint name=\"j" + n + "\" type=\"fixed\"><parent link=\"l" + std::to_string(i - 1) +
            "\"/><child link=\"l" + n + "\"/></joint>";
  }
  const Mechanism mechanism = read_text(text + "</robot>");
  EXPECT_EQ(mechanism.path(0, 4095).size(), 4095u);
}

// Comma locales have broken other readers: 0.5 became 0.
TEST(UrdfReads, NumbersAlikeInEveryLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  std::istringstream other("0.25");
  double seen = 0;
  other >> seen;
  const Mechanism mechanism = read_text(with(elbow, "xyz=\"1 2 3\"", "xyz=\"+1.5e-1\t.25\n-3.\""));
  std::locale::global(before);
  EXPECT_EQ(seen, 0) << "the locale does what it is there for";
  EXPECT_EQ(mechanism.joints[0].parent_from_joint.translation(), Vec3(0.15, 0.25, -3));
}

}  // namespace
}  // namespace lf::urdf::test
