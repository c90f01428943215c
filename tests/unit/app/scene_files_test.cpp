// `lanternfish check scene` and `lanternfish new`, run as a user runs them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/unit/app/program.hpp"

namespace lf::app {

namespace {

using Json = nlohmann::json;

class SceneFiles : public Program {
 protected:
  Json json_of(const std::string& arguments, int status = 0) const {
    const Said said = run(arguments + " --json");
    EXPECT_EQ(said.status, status) << said.err;
    return Json::parse(said.out);  // throws, and the test fails, when anything else is on stdout
  }
};

TEST_F(SceneFiles, AreToldAndDrawnByCheck) {
  const std::string shipped = LANTERNFISH_SOURCE_DIR "/shared/scenarios/scenes/clutter.yaml";
  const std::string picture = file("scene.png", "");
  const Json scene = json_of("check scene " + shipped + " --picture " + picture);
  ASSERT_EQ(scene["objects"].size(), 3u);
  EXPECT_EQ(scene["objects"][0]["name"], "pipe");
  EXPECT_NEAR(scene["objects"][0]["most_m"][0].get<double>(), 0.35, 1e-9);
  EXPECT_EQ(scene["objects"][2]["triangles"], 320);
  EXPECT_GT(std::filesystem::file_size(picture), 100'000u);
  const Said said = run("check scene " + shipped);
  EXPECT_EQ(said.status, 0) << said.err;
  for (const char* part : {"3 objects", "grab bar", "320 triangles", "metres"})
    EXPECT_NE(said.out.find(part), std::string::npos) << part << "\n" << said.out;

  const std::string bad = file("bad.yaml", "version: 1\nobjects:\n  - {name: a, kind: box}\n  - {name: a, kind: sphere, radius_m: 9}\n");
  const Json refused = json_of("check scene " + bad, 2);
  EXPECT_EQ(refused["problems"].size(), 2u) << refused;
  EXPECT_EQ(run("check scene " + bad + " --tool a").status, 2);
  EXPECT_EQ(run("check arm " LANTERNFISH_TEST_DATA "/arms/ur5/ur5.urdf --picture a.png").status, 2);
}

// What it writes is taken as it stands, and with every '#' taken away it is the default scenario.
TEST_F(SceneFiles, AndScenariosThatNewWritesAreTaken) {
  const std::string mission = file("unused", "") + "_mission";
  EXPECT_EQ(run("new scenario " + mission).status, 0);
  EXPECT_EQ(run("scenarios " + mission + ".yaml").status, 0);
  const Said again = run("new scenario " + mission);
  EXPECT_EQ(again.status, 2);
  EXPECT_NE(again.err.find("is there already"), std::string::npos) << again.err;
  EXPECT_EQ(run("new scene " + mission + "_scene.yaml").status, 0);
  EXPECT_EQ(json_of("check scene " + mission + "_scene.yaml")["objects"].size(), 1u);
  EXPECT_EQ(run("new machine " + mission).status, 2);

  std::ifstream written(mission + ".yaml");
  std::string whole;
  for (std::string line; std::getline(written, line);) {
    if (!line.starts_with("# ") || line.starts_with("#  ")) whole += (line.starts_with("#") ? line.substr(1) : line) + "\n";
  }
  const std::string uncommented = file("uncommented.yaml", whole);
  const auto keys_of = [&](const std::string& scenario) {
    std::string text = json_of("scenarios " + scenario)["yaml"];
    return text.substr(text.find("time_limit_s"));  // after the description
  };
  EXPECT_EQ(keys_of(uncommented), keys_of("default"));
}

}  // namespace
}  // namespace lf::app
