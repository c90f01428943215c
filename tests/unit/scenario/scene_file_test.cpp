#include "host_sim/scenario/scene_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "host_sim/scenario/instance.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::scenario {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

using Folder = test::TemporaryFolder;

// What is said of it, less the file's name; "" when it is taken.
std::string complaint(const std::string& text) {
  const Folder folder;
  const fs::path file = folder.write("scene.yaml", text);
  try {
    (void)read_scene_file(file);
    return "";
  } catch (const InputError& problem) {
    std::string message = problem.what();
    for (std::size_t at = message.find(file.string()); at != std::string::npos; at = message.find(file.string()))
      message.erase(at, file.string().size());
    return message;
  }
}

constexpr const char* tetrahedron =
    "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\n"
    "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

TEST(SceneFile, ReadsEveryKind) {
  const Folder folder;
  fs::create_directory(folder.path() / "meshes");
  folder.write("meshes/rock.obj", tetrahedron);
  const fs::path file = folder.write("scene.yaml", R"(
version: 1
objects:
  - {name: post, kind: box, size_m: [0.1, 0.2, 0.3], position_m: [1, 2, 3], turn_deg: [0, 0, 90], albedo: [0.1, 0.2, 0.3], friction: 0.4}
  - {name: ball, kind: sphere, radius_m: 0.07, frame: vehicle}
  - {name: pipe, kind: cylinder, radius_m: 0.02, length_m: 0.5}
  - {name: hose, kind: capsule, radius_m: 0.03, length_m: 0.4}
  - {name: rock, kind: mesh, file: meshes/rock.obj, scale: 0.001}
)");
  const SceneFile scene = read_scene_file(file);
  ASSERT_EQ(scene.objects.size(), 5u);
  const scene::Body& post = scene.objects[0].body;
  EXPECT_EQ(post.name, "post");
  EXPECT_EQ(post.role, scene::Role::object);
  EXPECT_EQ(post.shapes[0].kind, scene::ShapeKind::box);
  EXPECT_EQ(post.shapes[0].size_m, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(post.shapes[0].albedo, (std::array<float, 3>{0.1F, 0.2F, 0.3F}));
  EXPECT_EQ(post.shapes[0].friction, 0.4);
  EXPECT_TRUE((post.base_from_body * Vec3(1, 0, 0)).isApprox(Vec3(1, 3, 3), 1e-12));
  EXPECT_EQ(scene.objects[1].body.shapes[0].size_m.x(), 0.07);
  EXPECT_EQ(scene.objects[2].body.shapes[0].size_m, Vec3(0.02, 0, 0.5));
  EXPECT_EQ(scene.objects[3].body.shapes[0].kind, scene::ShapeKind::capsule);
  EXPECT_TRUE(scene.objects[4].body.shapes[0].vertices_m[1].isApprox(Vec3(0.1, 0, 0)));
  EXPECT_EQ(scene.objects[4].body.shapes[0].triangles.size(), 4u);
  EXPECT_EQ(scene.objects[4].mesh, file.parent_path() / "meshes/rock.obj");

  Pose panel = Pose::Identity();
  panel.translation() = Vec3(0.4, 0, 0.6);
  panel.linear() = Eigen::AngleAxisd(-pi / 2, Vec3::UnitX()).toRotationMatrix();
  const std::vector<scene::Body> placed = placed_objects(scene, panel);
  EXPECT_TRUE(placed[0].base_from_body.isApprox(panel * post.base_from_body));
  EXPECT_TRUE(placed[1].base_from_body.isApprox(Pose::Identity())) << "what stands on the vehicle goes where the base goes";
}

// Roll, pitch and yaw about fixed axes, as a URDF's rpy: x first.
TEST(SceneFile, TurnsAboutXThenYThenZ) {
  const Folder folder;
  const SceneFile scene =
      read_scene_file(folder.write("scene.yaml", "version: 1\nobjects: [{name: a, kind: sphere, radius_m: 1, turn_deg: [90, 90, 0]}]\n"));
  EXPECT_TRUE((scene.objects[0].body.base_from_body * Vec3(0, 1, 0)).isApprox(Vec3(1, 0, 0), 1e-12));
}

TEST(SceneFile, TellsHowFarItsObjectsReach) {
  const Folder folder;
  const SceneFile scene = read_scene_file(folder.write("scene.yaml", R"(
version: 1
objects:
  - {name: pipe, kind: cylinder, radius_m: 0.02, length_m: 0.7, position_m: [0, -0.3, 0.05], turn_deg: [0, 90, 0]}
  - {name: hose, kind: capsule, radius_m: 0.03, length_m: 0.4}
  - {name: ball, kind: sphere, radius_m: 0.5, position_m: [1, 0, 0]}
)"));
  EXPECT_TRUE(extent_of(scene.objects[0].body).least_m.isApprox(Vec3(-0.35, -0.32, 0.03), 1e-9));
  EXPECT_TRUE(extent_of(scene.objects[0].body).most_m.isApprox(Vec3(0.35, -0.28, 0.07), 1e-9));
  EXPECT_TRUE(extent_of(scene.objects[1].body).most_m.isApprox(Vec3(0.03, 0.03, 0.23), 1e-9));
  EXPECT_TRUE(extent_of(scene.objects[2].body).least_m.isApprox(Vec3(0.5, -0.5, -0.5), 1e-9));
}

// Turned at random: against the farthest of many points of each surface.
TEST(SceneFile, ATurnedObjectReachesAsFarAsItsSurface) {
  constexpr std::uint64_t seed = 5;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> turn(-pi, pi);
  for (const scene::ShapeKind kind :
       {scene::ShapeKind::box, scene::ShapeKind::sphere, scene::ShapeKind::cylinder, scene::ShapeKind::capsule}) {
    scene::Body body;
    scene::Shape& shape = body.shapes.emplace_back();
    shape.kind = kind;
    shape.size_m = kind == scene::ShapeKind::box ? Vec3(0.1, 0.2, 0.3) : Vec3(0.1, 0, kind == scene::ShapeKind::sphere ? 0 : 0.5);
    body.base_from_body =
        Pose(Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(turn(random), Vec3(turn(random), turn(random), turn(random)).normalized()));
    Vec3 most_m = Vec3::Constant(-1e9);
    for (int i = 0; i < 200; ++i) {
      for (int j = 0; j <= 200; ++j) {
        const double around = 2 * pi * i / 200, up = pi * j / 200;
        const Vec3 round = 0.1 * Vec3(std::sin(up) * std::cos(around), std::sin(up) * std::sin(around), std::cos(up));
        Vec3 point = round;
        if (kind == scene::ShapeKind::capsule) point.z() += std::copysign(0.25, round.z());
        if (kind == scene::ShapeKind::cylinder) point = Vec3(0.1 * std::cos(around), 0.1 * std::sin(around), j % 2 == 0 ? 0.25 : -0.25);
        if (kind == scene::ShapeKind::box)
          point = 0.5 * shape.size_m.cwiseProduct(Vec3(i % 2 == 0 ? 1 : -1, j % 2 == 0 ? 1 : -1, i % 4 < 2 ? 1 : -1));
        most_m = most_m.cwiseMax(body.base_from_body * point);
      }
    }
    const Vec3 found_m = extent_of(body).most_m;
    EXPECT_LT((found_m - most_m).cwiseAbs().maxCoeff(), 1e-4) << "seed " << seed << ", kind " << int(kind);
    EXPECT_TRUE((found_m.array() >= most_m.array() - 1e-12).all());
  }
}

// What a run keeps says the same again.
TEST(SceneFile, WrittenAnewItSaysTheSame) {
  const Folder folder;
  folder.write("rock.obj", tetrahedron);
  const SceneFile scene = read_scene_file(folder.write("scene.yaml", R"(
version: 1
objects:
  - {name: "a: 'post' [x]", kind: box, size_m: [0.1, 0.2, 0.3], position_m: [1, 2, 3], turn_deg: [10, 20, 30], albedo: [0.1, 0.2, 0.3], friction: 0.4}
  - {name: rock, kind: mesh, file: ./rock.obj, scale: 0.001, frame: vehicle}
)"));
  const SceneFile again = read_scene_file(folder.write("again.yaml", scene_yaml(scene, {"", "rock.obj"})));
  ASSERT_EQ(again.objects.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again.objects[i].body.name, scene.objects[i].body.name);
    EXPECT_EQ(again.objects[i].body.base_from_body.matrix(), scene.objects[i].body.base_from_body.matrix());
    EXPECT_EQ(again.objects[i].body.shapes[0].size_m, scene.objects[i].body.shapes[0].size_m);
    EXPECT_EQ(again.objects[i].body.shapes[0].vertices_m, scene.objects[i].body.shapes[0].vertices_m);
    EXPECT_EQ(again.objects[i].body.shapes[0].albedo, scene.objects[i].body.shapes[0].albedo);
    EXPECT_EQ(again.objects[i].said.frame, scene.objects[i].said.frame);
  }
  EXPECT_EQ(read_scene_file(folder.write("none.yaml", scene_yaml(SceneFile{}, {}))).objects.size(), 0u);
}

TEST(SceneFile, AMeshThatIsUsedTwiceIsToldForEachScale) {
  const Folder folder;
  folder.write("rock.obj", tetrahedron);
  const SceneFile scene = read_scene_file(folder.write(
      "scene.yaml",
      "version: 1\nobjects: [{name: a, kind: mesh, file: rock.obj, scale: 0.001}, {name: b, kind: mesh, file: ./rock.obj, scale: 0.002},\n"
      "{name: c, kind: mesh, file: rock.obj, scale: 0.001}]\n"));
  EXPECT_EQ(scene.notes.size(), 2u);
  EXPECT_EQ(scene.objects[0].mesh, scene.objects[1].mesh);
}

// The objects enter the world where the seed has put the panel, and a file that stands in the robot is refused before a run.
TEST(SceneFile, StandsInTheScenariosWorld) {
  const Folder folder;
  folder.write("rock.obj", tetrahedron);
  const std::string things = folder.write(
      "things.yaml", "version: 1\nobjects: [{name: rock, kind: mesh, file: rock.obj, scale: 0.001, position_m: [0.2, -0.2, 0.1]}]\n");
  const Scenario scenario = load_scenario("default", {"scene=" + things});
  EXPECT_NO_THROW(check_runnable(scenario));
  const Sample sample = draw(scenario, 7);
  const hal::SimConfig truth = make_truth(scenario, sample, make_nominal(scenario, false), 1);
  ASSERT_EQ(truth.world.scene.size(), scene::own_body_count(scene::bare_scene()) + 1);
  EXPECT_EQ(truth.optics.scene.size(), truth.world.scene.size());
  const Pose expected = truth.world.base_from_panel * Eigen::Translation3d(0.2, -0.2, 0.1);
  EXPECT_TRUE(truth.world.scene.back().base_from_body.isApprox(expected));

  const std::string clash =
      folder.write("clash.yaml", "version: 1\nobjects: [{name: post, kind: box, size_m: [0.1, 0.1, 0.1], position_m: [0, 0, 0.05]}]\n");
  try {
    check_runnable(load_scenario("default", {"scene=" + clash}));
    FAIL() << "taken";
  } catch (const InputError& problem) {
    EXPECT_THAT(problem.what(), HasSubstr("'post' stands in the handle"));
    EXPECT_THAT(problem.what(), HasSubstr("mm off its place"));
  }
  EXPECT_THROW(load_scenario("default", {"scene=absent.yaml"}), InputError);
}

// Regenerate with: lanternfish scenarios --scene-schema > shared/scenes/scene.schema.json
TEST(SceneFile, TheShippedSchemaAndTheUsersPageAreThoseOfTheTable) {
  const auto text_of = [](const char* path) {
    std::ifstream in(std::string(LANTERNFISH_SOURCE_DIR) + "/" + path, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(in), {}};
  };
  EXPECT_EQ(text_of("shared/scenes/scene.schema.json"), scene_schema());
  EXPECT_NE(text_of("docs/scenarios.md").find(scene_keys_markdown()), std::string::npos);
}

TEST(SceneFile, TheShippedOneIsRead) {
  const SceneFile scene = read_scene_file(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/scenes/clutter.yaml");
  EXPECT_EQ(scene.objects.size(), 3u);
  ASSERT_TRUE(load_scenario("cluttered").objects);
  EXPECT_EQ(load_scenario("cluttered").objects->objects.size(), 3u);
}

TEST(SceneFile, AFileWithoutObjectsIsAnEmptyScene) { EXPECT_EQ(complaint("version: 1\n"), ""); }

struct Bad {
  const char* text;
  const char* said;
};
class BadScene : public testing::TestWithParam<Bad> {};
TEST_P(BadScene, IsRefusedWithItsLineAndCause) { EXPECT_THAT(complaint(GetParam().text), HasSubstr(GetParam().said)); }

INSTANTIATE_TEST_SUITE_P(
    SceneFile, BadScene,
    testing::Values(
        Bad{"version: 1\nobjects: []\nobjects: []\n", ":3: 'objects' is given twice"},
        Bad{"version: 1\nobjects:\n  - {name: \"a\\eb\", kind: sphere, radius_m: 1}\n", "a letter that cannot be printed"},
        Bad{"[1, 2]\n", ":1: a scene is a group of keys"}, Bad{"objects: []\n", "has no version"},
        Bad{"version: 2\n", ":1: 'version' is 2, out of its range 1 to 1"}, Bad{"version: 1\nobject: []\n", ":2: unknown key 'object'"},
        Bad{"version: 1\nobjects: 3\n", ":2: 'objects' takes a list"}, Bad{"version: 1\nobjects: [box]\n", "takes a group of keys"},
        Bad{"version: 1\nobjects:\n  - {kind: box, size_m: [1, 1, 1]}\n", ":3: 'objects[0]' has no name"},
        Bad{"version: 1\nobjects:\n  - {name: a, size_m: [1, 1, 1]}\n", "has no kind"},
        Bad{"version: 1\nobjects:\n  - {name: a, kind: box}\n", "is a box and has no size_m"},
        Bad{"version: 1\nobjects:\n  - {name: a, kind: box, size_m: [1, 1, 1], radius_m: 1}\n", "objects[0].radius_m': a box has none"},
        Bad{"version: 1\nobjects:\n  - {name: a, kind: bix, size_m: [1, 1, 1]}\n", "did you mean 'box'"},
        Bad{"version: 1\nobjects:\n  - {name: a, kind: box, size: [1, 1, 1]}\n", "did you mean 'objects[0].size_m'"},
        Bad{"version: 1\nobjects:\n  - {name: a, kind: box, size_m: [1, .nan, 1]}\n", "must be a finite number"},
        Bad{"version: 1\nobjects:\n  - {name: a, kind: box, size_m: [1, -1, 1]}\n", "out of its range"},
        Bad{"version: 1\nobjects:\n  - {name: a, kind: sphere, radius_m: 0.1, albedo: [0, 0, 1.5]}\n", "out of its range 0 to 1"},
        Bad{"version: 1\nobjects:\n  - {name: a, kind: sphere, radius_m: 0.1, frame: arm}\n",
            "objects[0].frame' takes one of panel or vehicle, not 'arm'"},
        Bad{"version: 1\nobjects:\n  - {name: handle, kind: sphere, radius_m: 0.1}\n", "there is another 'handle'"},
        Bad{"version: 1\nobjects:\n  - {name: a, kind: mesh, file: none.obj}\n", "none.obj"},
        Bad{"version: 1\nobjects:\n  - {name: a, kind: sphere, radius_m: 0.1}\n  - {name: a, kind: sphere, radius_m: 0.1}\n", ":4: "}));

TEST(SceneFile, TellsAllProblemsAtOnce) {
  const std::string said = complaint("version: 3\nobjects:\n  - {name: a, kind: box}\n  - {name: b, kind: sphere, radius_m: -1}\n");
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2) << said;
}

TEST(SceneFile, AnOpenMeshIsRefused) {
  const Folder folder;
  folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
  try {
    (void)read_scene_file(folder.write("scene.yaml", "version: 1\nobjects: [{name: a, kind: mesh, file: open.obj}]\n"));
    FAIL() << "taken";
  } catch (const InputError& problem) {
    EXPECT_THAT(problem.what(), HasSubstr("open"));
  }
}

// Letters dropped, doubled and swapped, lines dropped and doubled, values of other kinds and sizes: each is read or refused with the file's name.
TEST(SceneFile, AChangedFileIsReadOrRefused) {
  constexpr std::uint64_t seed = 11;
  const Folder folder;
  folder.write("boulder.obj", tetrahedron);
  std::ifstream in(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/scenes/clutter.yaml", std::ios::binary);
  const std::string shipped{std::istreambuf_iterator<char>(in), {}};
  const char* const values[] = {".nan",      "-.inf",   "1e300",  "-1", "''", "[]", "{}", "[1, 2]", "true", "~", "../../boulder.obj",
                                "/dev/null", "&a [*a]", "!!int 3"};
  std::mt19937_64 random(seed);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string text = shipped;
    for (std::size_t change = 0; change <= below(3); ++change) {
      const std::size_t at = below(text.size());
      const std::size_t begin = text.rfind('\n', at) + 1, end = std::min(text.find('\n', at), text.size() - 1) + 1;
      switch (below(5)) {
        case 0: text.erase(at, 1); break;
        case 1: text.insert(at, 1, "\t:{}[]-#&*!|>'\"%@\0\xff"[below(19)]); break;
        case 2: text.erase(begin, end - begin); break;
        case 3: text.insert(begin, text.substr(begin, end - begin)); break;
        default:
          if (const std::size_t colon = text.find(": ", begin); colon < end)
            text.replace(colon + 2, end - colon - 3, values[below(std::size(values))]);
      }
      if (text.empty()) text = "\n";
    }
    try {
      (void)read_scene_file(folder.write("scene.yaml", text));
    } catch (const InputError& problem) {
      ++refused;
      EXPECT_THAT(problem.what(), HasSubstr("scene.yaml")) << "seed " << seed << ", change " << i;
    }
  }
  EXPECT_GT(refused, 200) << "seed " << seed;
}

TEST(SceneFile, HoldsNoMoreThanAScene) {
  std::string text = "version: 1\nobjects:\n";
  for (int i = 0; i < 52; ++i) text += "  - {name: o" + std::to_string(i) + ", kind: sphere, radius_m: 0.1}\n";
  EXPECT_THAT(complaint(text), HasSubstr("'objects' has 52, and a scene holds 51"));
}

}  // namespace
}  // namespace lf::scenario
