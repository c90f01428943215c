// `lanternfish check arm`, run as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/app/program.hpp"

namespace lf::app {

namespace {

using Json = nlohmann::json;

class CheckArm : public Program {};

// The joints as the maker's page has them, and the tool within the 0.950 m that 50,000 random postures come to.
TEST_F(CheckArm, ReadsAnArmOfAnotherMaker) {
  const std::string ur5 = LANTERNFISH_TEST_DATA "/arms/ur5/ur5.urdf";
  const Json arm = json_of("check arm " + ur5);
  ASSERT_EQ(arm["joints"].size(), 6u);
  EXPECT_EQ(arm["joints"][2]["name"], "elbow_joint");
  EXPECT_NEAR(arm["joints"][2]["upper"].get<double>(), 3.14159265, 1e-8);
  EXPECT_EQ(arm["tool_link"], "tool0");
  EXPECT_EQ(arm["inverse_kinematics"]["family"], "three parallel axes");
  EXPECT_EQ(arm["inverse_kinematics"]["postures"], 200);
  EXPECT_EQ(arm["inverse_kinematics"]["found"], 200);
  EXPECT_EQ(arm["inverse_kinematics"]["by_closed_form"], 200);
  EXPECT_GT(arm["tool_seen"]["farthest_m"].get<double>(), 0.9);
  EXPECT_LT(arm["tool_seen"]["farthest_m"].get<double>(), 0.96);
  const Said said = run("check arm " + ur5);
  EXPECT_EQ(said.status, 0) << said.err;
  for (const char* part : {"6 joints", "shoulder_pan_joint", "three parallel axes", "200 of them are found again"})
    EXPECT_NE(said.out.find(part), std::string::npos) << part << "\n" << said.out;
}

TEST_F(CheckArm, SaysWhatIsWrongWithAnArmAndWhere) {
  const std::string bad = file("bad.urdf", "<robot name='r'>\n<link name='a'/>\n<link name='a'/>\n</robot>\n");
  const Json refused = json_of("check arm " + bad, 2);
  ASSERT_GE(refused["problems"].size(), 1u);
  EXPECT_NE(refused["problems"][0].get<std::string>().find("bad.urdf:3"), std::string::npos) << refused;
  EXPECT_EQ(run("check arm absent.urdf").status, 2);
  const Said ambiguous = run("check arm " LANTERNFISH_TEST_DATA "/arms/open_manipulator_x/open_manipulator_x.urdf");
  EXPECT_EQ(ambiguous.status, 2);
  EXPECT_NE(ambiguous.err.find("say which link is the tool"), std::string::npos) << ambiguous.err;
  // An opening square to the approach is found where none is given.
  EXPECT_EQ(run("check arm --approach x " LANTERNFISH_TEST_DATA "/arms/ur5/ur5.urdf").status, 0);
  EXPECT_EQ(run("check arm --approach x --opening=-x " LANTERNFISH_TEST_DATA "/arms/ur5/ur5.urdf").status, 2);
  EXPECT_EQ(run("check arms " + bad).status, 2);
  EXPECT_NE(run("check arms " + bad).err.find("did you mean 'arm'?"), std::string::npos);
}

TEST_F(CheckArm, TellsEachEndAndAxisThatItAssumed) {
  const std::string ur5 = LANTERNFISH_TEST_DATA "/arms/ur5/ur5.urdf";
  const auto notes = [&](const std::string& options) { return json_of("check arm --postures 1 " + options + " " + ur5)["notes"].dump(); };
  const std::string assumed = notes("");
  for (const char* part : {"begin at the root 'base_link' (--base)", "'tool0' is taken to carry the tool",
                           "approach along its z (--approach)", "open along its x (--opening)"})
    EXPECT_NE(assumed.find(part), std::string::npos) << part << "\n" << assumed;
  EXPECT_NE(notes("--approach x").find("open along its y (--opening)"), std::string::npos);
  const std::string given = notes("--base base_link --tool tool0 --approach x --opening z");
  EXPECT_EQ(given.find("is taken"), std::string::npos) << given;
}

TEST_F(CheckArm, RefusesWhatLeavesItNothingToLookAt) {
  const std::string ur5 = LANTERNFISH_TEST_DATA "/arms/ur5/ur5.urdf";
  for (const char* option : {"--tool", "--base", "--approach", "--opening"}) {
    const Said said = run("check arm " + std::string(option) + " '' " + ur5);
    EXPECT_EQ(said.status, 2) << option;
    EXPECT_NE(said.err.find("is empty: give it a value, or leave the option out"), std::string::npos) << said.err;
  }
  const Said folder = run("check arm --packages absent " + ur5);
  EXPECT_EQ(folder.status, 2);
  EXPECT_NE(folder.err.find("takes a folder that is there, not 'absent'"), std::string::npos) << folder.err;
  EXPECT_EQ(run("check arm --postures 1 --packages " LANTERNFISH_TEST_DATA " " + ur5).status, 0) << "the file is not another folder";
  const std::string turning = file("turning.urdf",
                                   "<robot name='r'>\n<link name='a'/>\n<link name='b'/>\n<joint name='j' type='continuous'>\n<parent "
                                   "link='a'/><child link='b'/><axis xyz='0 0 1'/></joint>\n</robot>\n");
  const Said still = run("check arm " + turning);
  EXPECT_EQ(still.status, 2);
  EXPECT_NE(still.err.find("turning.urdf:3: the tool cannot move"), std::string::npos) << still.err;
}

TEST_F(CheckArm, LeavesOutMissingMeshesWhereItIsTold) {
  const std::string arm = file("meshes.urdf",
                               "<robot name='r'>\n<link name='a'/>\n<link name='b'><collision><geometry><mesh "
                               "filename='absent.stl'/></geometry></collision></link>\n<joint name='j' type='prismatic'>\n<parent "
                               "link='a'/><child link='b'/><limit lower='0' upper='1' effort='1' velocity='1'/></joint>\n</robot>\n");
  EXPECT_EQ(run("check arm " + arm).status, 2);
  const Said said = run("check arm --ignore-missing " + arm);
  EXPECT_EQ(said.status, 0) << said.err;
  EXPECT_NE(said.out.find("The collision is left out"), std::string::npos) << said.out;
}

}  // namespace

}  // namespace lf::app
