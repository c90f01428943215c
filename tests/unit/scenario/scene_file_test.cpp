#include "host_sim/scenario/scene_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>

#include "shared/input_error.hpp"

namespace lf::scenario {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// A folder for one test, gone with it.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("lanternfish_scene_" + std::to_string(::getpid()))) {
    fs::create_directories(path_ / "meshes");
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

 private:
  fs::path path_;
};

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
  folder.write("meshes/rock.obj", tetrahedron);
  const fs::path file = folder.write("scene.yaml", R"(
version: 1
objects:
  - {name: post, kind: box, size_m: [0.1, 0.2, 0.3], position_m: [1, 2, 3], turn_deg: [0, 0, 90], albedo: [0.1, 0.2, 0.3], friction: 0.4}
  - {name: ball, kind: sphere, radius_m: 0.07, on: vehicle}
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
  EXPECT_EQ(scene.meshes, (std::vector<fs::path>{file.parent_path() / "meshes/rock.obj"}));

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

// Regenerate with: lanternfish scenarios --scene-schema > shared/scenarios/scene.schema.json
TEST(SceneFile, TheShippedSchemaAndTheUsersPageAreThoseOfTheTable) {
  const auto text_of = [](const char* path) {
    std::ifstream in(std::string(LANTERNFISH_SOURCE_DIR) + "/" + path, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(in), {}};
  };
  EXPECT_EQ(text_of("shared/scenarios/scene.schema.json"), scene_schema());
  EXPECT_NE(text_of("docs/scenarios.md").find(scene_keys_markdown()), std::string::npos);
}

TEST(SceneFile, TheShippedOneIsRead) {
  const SceneFile scene = read_scene_file(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/scenarios/scenes/clutter.yaml");
  EXPECT_EQ(scene.objects.size(), 3u);
  EXPECT_EQ(scene_of(load_scenario("cluttered")).objects.size(), 3u);
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
        Bad{"version: 1\nobjects:\n  - {name: a, kind: sphere, radius_m: 0.1, on: arm}\n",
            "objects[0].on' takes one of panel or vehicle, not 'arm'"},
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
  std::ifstream in(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/scenarios/scenes/clutter.yaml", std::ios::binary);
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
