// Trap 10: where the files of meshes are.
#include "tests/unit/urdf/urdf_text.hpp"

namespace lf::urdf::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// A link whose only shape is a mesh: collision (or visual) in line 3, mesh in line 4.
std::string meshed(const std::string& filename, const std::string& shape = "collision", const std::string& attributes = "") {
  return "<robot name=\"r\">\n<link name=\"base\">\n<" + shape + "><geometry>\n<mesh filename=\"" + filename + "\"" + attributes +
         "/>\n</geometry></" + shape + ">\n</link></robot>\n";
}

// The URDF in ws/pkg/urdf/arm.urdf, and files beside and above it.
class MeshFiles : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_ / "ws/pkg/urdf"); }

  void put(const std::string& file, const std::string& text = "solid x\nendsolid x\n") {
    std::filesystem::create_directories((folder_.path() / file).parent_path());
    folder_.write(file, text);
  }
  // The mesh that the URDF names.
  Mesh mesh(const std::string& text, const ReadOptions& options = {}) {
    const Reading reading = read_urdf(folder_.write("ws/pkg/urdf/arm.urdf", text).string(), options);
    notes_.clear();
    for (const Note& note : reading.notes)
      if (note.line > 2) notes_.push_back(std::to_string(note.line) + ": " + note.text);
    const Link& link = reading.mechanism.links[0];
    if (!link.visuals.empty()) return std::get<Mesh>(link.visuals[0].geometry);
    return link.collisions.empty() ? Mesh{} : std::get<Mesh>(link.collisions[0].geometry);
  }
  // ":4: <mesh> ..."
  std::string error(const std::string& text, const ReadOptions& options = {}) {
    const std::string message = lf::test::message_of<InputError>([&] { (void)mesh(text, options); });
    const std::string file = folder_ / "ws/pkg/urdf/arm.urdf";
    EXPECT_THAT(message, StartsWith(file));
    return message.substr(std::min(message.size(), file.size()));
  }
  bool same(const Mesh& mesh, const std::string& file) const {
    return !mesh.file.empty() && std::filesystem::equivalent(mesh.file, folder_.path() / file);
  }

  lf::test::TemporaryFolder folder_;
  std::vector<std::string> notes_;
};

TEST_F(MeshFiles, RelativeAbsoluteAndFileUrlsAreFoundWithoutAWord) {
  put("ws/pkg/meshes/a.stl");
  for (const std::string& name :
       {std::string("../meshes/a.stl"), folder_ / "ws/pkg/meshes/a.stl", "file://" + (folder_ / "ws/pkg/meshes/a.stl")}) {
    EXPECT_TRUE(same(mesh(meshed(name)), "ws/pkg/meshes/a.stl")) << name;
    EXPECT_THAT(notes_, IsEmpty());
  }
}

TEST_F(MeshFiles, PackagesAreFoundAboveTheFileAndToldWhere) {
  put("ws/pkg/meshes/a.stl");
  for (const std::string scheme : {"package", "model"}) {
    EXPECT_TRUE(same(mesh(meshed(scheme + "://pkg/meshes/a.stl")), "ws/pkg/meshes/a.stl"));
    EXPECT_THAT(notes_, ElementsAre(AllOf(StartsWith("4: <mesh> of link 'base' names '" + scheme + "://pkg/meshes/a.stl', found as '"),
                                          HasSubstr("/ws/pkg/meshes/a.stl'"))));
  }
  put("ws/other/b.obj");
  EXPECT_TRUE(same(mesh(meshed("package://other/b.obj")), "ws/other/b.obj")) << "a neighbour of the package";
  put("ws/pkg/urdf/visual/c.ply");
  EXPECT_TRUE(same(mesh(meshed("package://unheard_of/visual/c.ply")), "ws/pkg/urdf/visual/c.ply")) << "beside the file";
}

TEST_F(MeshFiles, PackagesAreFoundFirstInTheGivenFolders) {
  put("ws/pkg/meshes/a.stl");
  put("mine/pkg/meshes/a.stl");
  EXPECT_TRUE(same(mesh(meshed("package://pkg/meshes/a.stl"), {{folder_ / "mine"}, false}), "mine/pkg/meshes/a.stl"));
}

// Other converters strip folders: then the second of these is the first.
TEST_F(MeshFiles, OfOneNameInTwoFoldersAreTwo) {
  put("ws/pkg/visual/a.stl");
  put("ws/pkg/collision/a.stl");
  EXPECT_TRUE(same(mesh(meshed("../visual/a.stl")), "ws/pkg/visual/a.stl"));
  EXPECT_TRUE(same(mesh(meshed("../collision/a.stl")), "ws/pkg/collision/a.stl"));
}

TEST_F(MeshFiles, ThatAreMissingAreRefusedWithTheRemedy) {
  EXPECT_EQ(
      error(meshed("../meshes/a.stl")),
      ":4: <mesh> of link 'base' names '../meshes/a.stl', which is not there: correct the name, add the file, or put a box, cylinder or "
      "sphere in its place, or leave it out (--ignore-missing)");
  EXPECT_THAT(error(meshed("package://pkg/meshes/a.stl")),
              HasSubstr("and package 'pkg' is neither in the given package folders nor in a folder above this file"));
  EXPECT_THAT(error(meshed("..\\meshes\\a.stl")), HasSubstr("which is not there: write / instead of \\"));
}

TEST_F(MeshFiles, OfAnotherCaseAreRefusedWithTheirName) {
  put("ws/pkg/Meshes/A.STL");
  EXPECT_THAT(error(meshed("../meshes/a.stl")), AllOf(HasSubstr("names '../meshes/a.stl', which is spelt '"),
                                                      HasSubstr("Meshes/A.STL' on the disk: write upper and lower case alike")));
  EXPECT_THAT(error(meshed("package://pkg/meshes/a.stl")), HasSubstr("Meshes/A.STL' on the disk"));
  EXPECT_TRUE(same(mesh(meshed("../Meshes/A.STL")), "ws/pkg/Meshes/A.STL"));
}

TEST_F(MeshFiles, OfVisualsMayBeMissingAndCollisionsOnRequest) {
  EXPECT_TRUE(mesh(meshed("a.stl", "visual")).file.empty());
  EXPECT_THAT(notes_, ElementsAre(AllOf(StartsWith("4: <mesh> of link 'base' names 'a.stl', which is not there"),
                                        HasSubstr("The visual is left out"))));
  EXPECT_TRUE(mesh(meshed("a.stl"), {{}, true}).file.empty());
  EXPECT_THAT(notes_, ElementsAre(AllOf(StartsWith("4: "), HasSubstr("The collision is left out"))));
}

TEST_F(MeshFiles, OfUnknownFormatsAndPlacesAreRefused) {
  put("ws/pkg/urdf/a.step");
  EXPECT_THAT(
      error(meshed("a.step")),
      HasSubstr(":4: <mesh> of link 'base' names 'a.step', which is of no known format: export it as STL, OBJ, PLY or COLLADA (.dae)"));
  EXPECT_THAT(error(meshed("https://example.org/a.stl")),
              HasSubstr("write a path relative to this file, package://NAME/PATH or file:///PATH"));
  for (const char* name : {"package://a.stl", "package:///a.stl"}) EXPECT_THAT(error(meshed(name)), HasSubstr("write package://NAME/PATH"));
  EXPECT_THAT(error(meshed("")), HasSubstr(":4: <mesh> of link 'base' has no filename: name the file of the mesh"));
}

TEST_F(MeshFiles, HaveTheScaleOfTheUrdf) {
  put("ws/pkg/urdf/a.stl");
  EXPECT_EQ(mesh(meshed("a.stl")).scale, Vec3::Ones());
  EXPECT_EQ(mesh(meshed("a.stl", "collision", " scale=\"0.001 0.002 0.003\"")).scale, Vec3(0.001, 0.002, 0.003));
  EXPECT_EQ(mesh(meshed("a.stl", "collision", " scale=\"1 -1 1\"")).scale, Vec3(1, -1, 1));
  EXPECT_THAT(notes_, ElementsAre("4: <mesh> of link 'base' has a negative scale: it is mirrored"));
  EXPECT_THAT(error(meshed("a.stl", "collision", " scale=\"1 0 1\"")), HasSubstr("has a scale of 0: it would be flat"));
  EXPECT_THAT(error(meshed("a.stl", "collision", " scale=\"2\"")), HasSubstr("scale='2' has to be 3 numbers"));
}

std::string collada(const std::string& asset) {
  return "<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\"><asset>" + asset + "</asset><library_geometries/></COLLADA>";
}

TEST_F(MeshFiles, HaveTheUnitThatTheyState) {
  put("ws/pkg/urdf/a.stl");
  EXPECT_EQ(mesh(meshed("a.stl")).metres_per_unit, 1);
  put("ws/pkg/urdf/mm.dae", collada("<unit name=\"millimeter\" meter=\"0.001\"/><up_axis>Z_UP</up_axis>"));
  EXPECT_EQ(mesh(meshed("mm.dae")).metres_per_unit, 0.001);
  EXPECT_THAT(notes_, IsEmpty());
  put("ws/pkg/urdf/m.DAE", collada("<created/>"));
  EXPECT_EQ(mesh(meshed("m.DAE")).metres_per_unit, 1);
  put("ws/pkg/urdf/y.dae", collada("<unit meter=\"0.0254\"/><up_axis>Y_UP</up_axis>"));
  EXPECT_EQ(mesh(meshed("y.dae")).metres_per_unit, 0.0254);
  EXPECT_THAT(notes_, ElementsAre("4: <mesh> of link 'base' is 'y.dae', which has 'Y_UP'; its vertices are used as they are"));
}

TEST_F(MeshFiles, WhoseUnitCannotBeReadAreRefused) {
  for (const char* meter : {"0", "-1", "nan", "1e9", "mm", ""}) {
    put("ws/pkg/urdf/a.dae", collada(std::string("<unit meter=\"") + meter + "\"/>"));
    EXPECT_EQ(error(meshed("a.dae")), std::string(":4: <mesh> of link 'base' is 'a.dae', whose <unit meter='") + meter +
                                          "'> is no length from 1e-6 to 1000 m: correct it");
  }
  put("ws/pkg/urdf/a.dae", "<COLLADA><asset><unit");
  EXPECT_THAT(error(meshed("a.dae")), HasSubstr("is 'a.dae', which has no readable <asset> with its unit: export it anew"));
}

}  // namespace
}  // namespace lf::urdf::test
