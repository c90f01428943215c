// The referee: Debian's assimp, an independent reader of the same formats. It keeps single precision and is permissive, so valid files alone are compared: by their
// triangles, corner by corner.
#include "tests/unit/mesh/readings.hpp"

#ifdef LANTERNFISH_HAS_ASSIMP
#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "tests/unit/temporary_folder.hpp"
#endif

namespace lf::mesh::test {
namespace {

#ifndef LANTERNFISH_HAS_ASSIMP

TEST(MeshReferee, Assimp) { GTEST_SKIP() << "missing: apt-get install libassimp-dev"; }

#else

using Corners = std::array<Eigen::Vector3f, 3>;

std::vector<Corners> by_assimp(const std::string& file) {
  std::vector<Corners> triangles;
  const aiScene* const scene = aiImportFile(file.c_str(), aiProcess_Triangulate | aiProcess_PreTransformVertices);
  EXPECT_NE(scene, nullptr) << aiGetErrorString();
  if (scene == nullptr) return triangles;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m)
    for (unsigned f = 0; f < scene->mMeshes[m]->mNumFaces; ++f) {
      const aiFace& face = scene->mMeshes[m]->mFaces[f];
      Corners corners;
      for (unsigned k = 0; k < 3 && k < face.mNumIndices; ++k) {
        const aiVector3D& v = scene->mMeshes[m]->mVertices[face.mIndices[k]];
        corners[k] = {v.x, v.y, v.z};
      }
      triangles.push_back(corners);
    }
  aiReleaseImport(scene);
  return triangles;
}

void expect_same_as_assimp(const std::string& name, const std::string& bytes) {
  SCOPED_TRACE(name);
  const lf::test::TemporaryFolder folder;
  const std::string file = folder.write(name, bytes).string();
  const Mesh mesh = read_mesh(file).mesh;
  const std::vector<Corners> theirs = by_assimp(file);
  ASSERT_EQ(theirs.size(), mesh.triangles.size());
  for (std::size_t i = 0; i < theirs.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      // Of text assimp rounds the digits in pieces: off by some last bits of single precision.
      EXPECT_LT((mesh.vertices_m[mesh.triangles[i][k]].cast<float>() - theirs[i][k]).norm(), 1e-6f) << "triangle " << i << ", corner " << k;
    }
}

TEST(MeshReferee, AssimpReadsTheSameTriangles) {
  for (const Mesh& mesh : {box({1, 2, 3}), sphere(0.3, 9), torus(0.5, 0.2, 12)}) {
    expect_same_as_assimp("a.obj", obj_of(mesh));
    expect_same_as_assimp("a.stl", text_stl_of(mesh));
    expect_same_as_assimp("a.stl", binary_stl_of(mesh));
    expect_same_as_assimp("a.stl", binary_stl_of(mesh, "solid made"));
    expect_same_as_assimp("a.ply", text_ply_of(mesh));
    expect_same_as_assimp("a.ply", binary_ply_of(mesh, false));
    expect_same_as_assimp("a.ply", binary_ply_of(mesh, true));
  }
}

TEST(MeshReferee, AssimpUnderstandsTheSameIndicesAndLines) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
  for (const char* face : {"f -4 -3 -2\n", "f 1//1 2//1 3//1\n", "f 1/1/1 2/1/1 3/1/1\n", "f 1/1 2/1 3/1\n", "f 1 \\\n2 3\n"})
    expect_same_as_assimp("a.obj", corners + face);
}

#endif

}  // namespace
}  // namespace lf::mesh::test
