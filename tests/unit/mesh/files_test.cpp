// Names, formats, sizes and units, and files that were cut off.
#include <filesystem>
#include <functional>

#include "shared/mesh/judge.hpp"
#include "tests/unit/mesh/readings.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::mesh::test {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

const std::string obj = obj_of(tetrahedron());
const std::string text_stl = text_stl_of(tetrahedron());
const std::string binary_stl = binary_stl_of(tetrahedron());
const std::string text_ply = text_ply_of(tetrahedron());
const std::string binary_ply = binary_ply_of(tetrahedron(), false);
const std::string big_endian_ply = binary_ply_of(tetrahedron(), true);

TEST(MeshFile, IsReadFromTheDisk) {
  const lf::test::TemporaryFolder folder;
  const std::string file = folder.write("a.OBJ", obj).string();
  const Reading reading = read_mesh(file);
  expect_same(reading.mesh, tetrahedron());
  EXPECT_EQ(reading.file, file);
  expect_same(read_mesh(folder.write("a.Ply", big_endian_ply).string()).mesh, tetrahedron());
}

TEST(MeshFile, ThatIsMissingAFolderOrEmptyIsRefused) {
  const lf::test::TemporaryFolder folder;
  const auto error = [](const std::string& file) { return lf::test::message_of<InputError>([&] { (void)read_mesh(file); }); };
  EXPECT_THAT(error(folder / "a.obj"), EndsWith("a.obj: there is no such file"));
  EXPECT_THAT(error(folder.path().string()), EndsWith(": is a folder, not a file"));
  EXPECT_THAT(error("/dev/zero"), EndsWith(": is no regular file: copy it into one"));
  for (const char* name : {"a.obj", "a.stl", "a.ply"})
    EXPECT_THAT(error(folder.write(name, "").string()), EndsWith(": is empty: export the mesh anew"));
}

// A file with a hole takes no room on the disk.
TEST(MeshFile, ThatIsTooLargeIsRefusedBeforeItIsRead) {
  const lf::test::TemporaryFolder folder;
  const std::string file = folder.write("a.stl", binary_stl).string();
  std::filesystem::resize_file(file, std::uintmax_t{1} << 40);
  EXPECT_THAT(lf::test::message_of<InputError>([&] { (void)read_mesh(file); }),
              EndsWith(": has 1048576 MB; 512 MB are read: decimate it in a mesh editor, or export it in binary"));
}

TEST(MeshFile, WhoseNameAndContentDisagreeIsRefused) {
  EXPECT_EQ(error_of("a.stl", obj), "a.stl: is STL by its name, but holds OBJ: let its name end in .obj");
  for (const std::string& stl : {text_stl, binary_stl}) {
    EXPECT_EQ(error_of("a.obj", stl), "a.obj: is OBJ by its name, but holds STL: let its name end in .stl");
    EXPECT_EQ(error_of("a.ply", stl), "a.ply: is PLY by its name, but holds STL: let its name end in .stl");
  }
  EXPECT_EQ(error_of("a.obj", binary_ply), "a.obj: is OBJ by its name, but holds PLY: let its name end in .ply");
  EXPECT_EQ(error_of("a", text_ply), "a: holds PLY: let its name end in .ply");
  EXPECT_EQ(error_of("a.mdl", "?"), "a.mdl: is of no known format: export it as OBJ, STL or PLY, and let its name say which");
}

TEST(MeshFile, OfOtherFormatsIsRefusedByItsName) {
  for (const auto& [file, name] : std::vector<std::pair<std::string, std::string>>{{"a.dae", "COLLADA"},
                                                                                   {"a.DAE", "COLLADA"},
                                                                                   {"a.gltf", "glTF"},
                                                                                   {"a.glb", "glTF"},
                                                                                   {"a.3mf", "3MF"},
                                                                                   {"a.fbx", "FBX"},
                                                                                   {"a.step", "STEP"}})
    EXPECT_EQ(error_of(file, "?"), file + ": is " + name + " by its name: export it as OBJ, STL or PLY");
  for (const auto& [bytes, name] :
       std::vector<std::pair<std::string, std::string>>{{"glTF\2", "glTF"},
                                                        {"{\"asset\": {}}", "JSON, as glTF is"},
                                                        {"PK\3\4", "a ZIP archive, as 3MF is"},
                                                        {"<?xml version=\"1.0\"?><COLLADA/>", "XML, as COLLADA is"}})
    EXPECT_EQ(error_of("a.obj", bytes), "a.obj: holds " + name + ": export it as OBJ, STL or PLY");
}

TEST(MeshFile, OfAnotherUnitIsRefusedWithTheScale) {
  Mesh mesh = box({340, 200, 100});
  EXPECT_EQ(error_of("a.obj", obj_of(mesh)), "a.obj: is 340 m long, more than 100 m: is it in millimetres? Then give it scale: 0.001");
  EXPECT_EQ(error_of("a.obj", obj_of(mesh), Vec3::Constant(1e-6)),
            "a.obj: is 0.00034 m long, less than 1 mm: was it scaled from millimetres twice? Then give it scale: 0.001");
  const Reading reading = parse_mesh("a.obj", obj_of(mesh), Vec3::Constant(0.001));
  EXPECT_EQ(reading.mesh.vertices_m.back(), Vec3(340 * 0.001, 200 * 0.001, 100 * 0.001));
  EXPECT_EQ(reading.notes.at(0).text,
            "states no unit and no axes: its numbers are taken as metres after the scale (0.001, 0.001, 0.001), and its axes as they are");
  for (Vec3& vertex : mesh.vertices_m) vertex = vertex / 10 + Vec3(5000, 0, 0);
  EXPECT_EQ(error_of("a.obj", obj_of(mesh)), "a.obj: lies 5034 m from its origin: move it there in a mesh editor");
}

TEST(MeshFile, WhoseScaleIsNoneIsRefused) {
  for (const double factor : {0.0, std::nan(""), HUGE_VAL, 1e7, -1e-10})
    EXPECT_THAT(error_of("a.obj", obj, Vec3(1, factor, 1)), HasSubstr("): each factor has to be from 1e-9 to 1e6; 0.001 for millimetres"))
        << factor;
}

TEST(MeshFile, ThatIsMirroredStaysTheSameSideOut) {
  const Reading reading = parse_mesh("a.obj", obj, Vec3(1, -2, 1));
  EXPECT_NEAR(measure(reading.mesh).volume_m3, 2.0 / 6, 1e-15);
  EXPECT_THAT(notes_of(reading), ElementsAre("0: is mirrored by its scale: its triangles are turned, so that their outside stays outside"));
  EXPECT_NEAR(measure(parse_mesh("a.obj", obj, Vec3(-1, -2, 1)).mesh).volume_m3, 2.0 / 6, 1e-15);
}

TEST(MeshFile, OfTooManyTrianglesIsRefused) {
  std::string text = obj;
  for (std::size_t i = 4; i < most_triangles; ++i) text += "f 1 2 3\n";
  EXPECT_EQ(error_of("a.obj", text + "f 1 2 3\n"),
            "a.obj:2000005: has 2000001 triangles or more; 2000000 are read: decimate it in a mesh editor, or split it");
  EXPECT_EQ(parse_mesh("a.obj", text).mesh.triangles.size(), most_triangles);
  text = "v 0 0 0\nf";
  for (std::size_t i = 0; i < most_triangles + 3; ++i) text += " 1";
  EXPECT_THAT(error_of("a.obj", text + " x"), StartsWith("a.obj:2: has 2000001 triangles or more")) << "in one face";
}

// Each shorter file, in a buffer of its own, so that a sanitizer sees what reads past its end.
void for_each_prefix(const std::string& bytes, const std::function<void(const std::string&)>& check) {
  for (std::size_t size = 0; size < bytes.size(); ++size) check(std::string(bytes, 0, size));
}

TEST(MeshFile, ThatIsCutOffAnywhereIsRefused) {
  for (const auto& [file, bytes] : std::vector<std::pair<std::string, std::string>>{
           {"a.stl", binary_stl}, {"a.stl", binary_stl_of(tetrahedron(), "solid x")}, {"a.ply", binary_ply}, {"a.ply", big_endian_ply}})
    for_each_prefix(bytes, [&](const std::string& cut) { EXPECT_THAT(error_of(file, cut), StartsWith(file + ":")) << cut.size(); });
  // The last word of text STL is a name; the last byte of text PLY its last line's end.
  for_each_prefix(text_stl.substr(0, text_stl.find("endsolid") + 8),
                  [](const std::string& cut) { EXPECT_THAT(error_of("a.stl", cut), StartsWith("a.stl:")) << cut; });
  for_each_prefix(text_ply.substr(0, text_ply.size() - 1),
                  [](const std::string& cut) { EXPECT_THAT(error_of("a.ply", cut), StartsWith("a.ply:")) << cut; });
  EXPECT_THAT(notes_of(parse_mesh("a.ply", text_ply.substr(0, text_ply.size() - 1))),
              ElementsAre("17: has no end of line, and is the last: was it cut off?"));
}

// OBJ has no end, and no count.
TEST(MeshFile, ThatIsAnObjCutOffIsRefusedToldOrNoSolid) {
  for_each_prefix(obj, [](const std::string& cut) {
    const std::string error = error_of("a.obj", cut);
    if (!error.empty()) {
      EXPECT_THAT(error, StartsWith("a.obj:"));
      return;
    }
    const Reading reading = parse_mesh("a.obj", cut);
    EXPECT_EQ(notes_of(reading).size(), cut.ends_with('\n') ? 0U : 1U) << cut;
    EXPECT_EQ(judge(reading.mesh).any(), cut.size() + 1 < obj.size()) << cut;
  });
}

TEST(MergedVertices, KeepTheOrderOfTheirFirst) {
  Mesh mesh{{{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -0.0}, {1, 1, 1}}, {{0, 1, 3}, {4, 2, 5}}};
  EXPECT_EQ(merge_vertices(mesh), 2U);
  expect_same(mesh, {{{1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 1, 1}}, {{0, 1, 2}, {1, 0, 3}}});
  EXPECT_EQ(merge_vertices(mesh), 0U);
}

}  // namespace
}  // namespace lf::mesh::test
