// `lanternfish check scene` and `lanternfish new`, run as a user runs them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "tests/unit/app/program.hpp"
#include "tests/unit/read_picture.hpp"

namespace lf::app {

namespace {

using Json = nlohmann::json;

class SceneFiles : public Program {};

TEST_F(SceneFiles, AreToldAndDrawnByCheck) {
  const std::string shipped = LANTERNFISH_SOURCE_DIR "/shared/scenes/clutter.yaml";
  const std::string picture = file("scene.png", "");
  const Json scene = json_of("check scene " + shipped + " --picture " + picture);
  ASSERT_EQ(scene["objects"].size(), 3u);
  EXPECT_EQ(scene["objects"][0]["name"], "pipe");
  EXPECT_NEAR(scene["objects"][0]["most_m"][0].get<double>(), 0.35, 1e-9);
  EXPECT_EQ(scene["objects"][2]["triangles"], 320);
  // It differs from that of an empty scene where the objects and their shadows are.
  const std::string empty = file("empty.yaml", "version: 1\n"), without = file("without.png", "");
  EXPECT_EQ(run("check scene " + empty + " --picture " + without).status, 0);
  cv::Mat difference;
  cv::absdiff(read_picture(picture), read_picture(without), difference);
  EXPECT_GT(cv::countNonZero(difference.reshape(1) > 40), 5'000);
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

// The scenario that a run keeps finds its scene again, a shipped one and one's own with its mesh.
TEST_F(SceneFiles, AreKeptWithTheRun) {
  std::filesystem::create_directories(folder() / "things" / "meshes");
  std::filesystem::copy_file(LANTERNFISH_SOURCE_DIR "/shared/scenes/boulder.obj", folder() / "things" / "meshes" / "my rock.obj");
  (void)file("things/dock.yaml",
             "version: 1\nobjects: [{name: rock, kind: mesh, file: meshes/my rock.obj, scale: 0.001, position_m: [0, -0.3, 0]}]\n");
  const std::string own = file("own.yaml", "scene: things/dock.yaml\n");
  const std::string few = " --quiet --no-outside --set time_limit_s=1 --out ";
  EXPECT_EQ(run("run " + own + few + (folder() / "of_own").string()).status, 1) << "a second is too short";
  EXPECT_EQ(run("run cluttered" + few + (folder() / "of_shipped").string()).status, 1);
  EXPECT_EQ(text_of(folder() / "of_own" / "scene" / "mesh_1.obj"), text_of(LANTERNFISH_SOURCE_DIR "/shared/scenes/boulder.obj"));
  const std::string experiment = text_of(folder() / "of_own" / "experiment.json");
  EXPECT_NE(experiment.find("file things/dock.yaml"), std::string::npos);
  EXPECT_NE(experiment.find("file meshes/my rock.obj of things/dock.yaml"), std::string::npos);
  // Another mesh under the same name is another experiment.
  (void)file("things/meshes/my rock.obj", "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  EXPECT_NE(run("run " + own + few + (folder() / "of_own").string()).err.find("my rock.obj"), std::string::npos);
  std::filesystem::remove_all(folder() / "things");
  for (const char* kept : {"of_own", "of_shipped"}) {
    const Said again = run("scenarios " + (folder() / kept / "scenario.yaml").string());
    EXPECT_EQ(again.status, 0) << again.err;
  }
  EXPECT_EQ(run("scenarios " + own).status, 2) << "its scene is gone";
}

// What stands in the arm's way is met, and told by its name.
TEST_F(SceneFiles, AreMetByTheArm) {
  const std::string wall =
      file("wall.yaml",
           "version: 1\nobjects: [{name: wall, kind: box, size_m: [0.02, 0.5, 0.02], frame: vehicle, position_m: [0.2, 0, 0.5]}]\n");
  const std::string out = (folder() / "out").string();
  const Said said = run("run default --quiet --no-outside --set time_limit_s=14 --set scene=" + wall + " --out " + out);
  EXPECT_EQ(said.status, 1) << said.err;
  const Json result = Json::parse(text_of(folder() / "out" / "result.json"));
  EXPECT_GT(result["contact"]["unintended_contacts"], 0);
  EXPECT_NE(text_of(folder() / "out" / "report.html").find(" and wall at "), std::string::npos);
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
  EXPECT_EQ(run("new scene ''").status, 2);
  EXPECT_EQ(run("new scene \"$(printf 'a\\nb')\"").status, 2) << "a name that would break the file's comments";
  EXPECT_EQ(run("new scene " + mission + "_THIS_FILE").status, 0);

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
  EXPECT_EQ(keys_of(mission + ".yaml"), keys_of("default")) << "as it stands";
}

}  // namespace
}  // namespace lf::app
