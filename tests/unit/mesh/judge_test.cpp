// Each fault alone, with its place, and all of them at once.
#include "shared/mesh/judge.hpp"

#include <random>

#include "tests/unit/mesh/readings.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::mesh::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

// In the order of the members.
std::vector<std::size_t> counts_of(const Mesh& mesh) {
  const MeshFaults f = judge(mesh);
  return {f.open_edges.count, f.crowded_edges.count, f.inconsistent_edges.count, f.inside_out_shells.count,
          f.degenerate.count, f.duplicates.count,    f.unused_vertices.count};
}

TEST(Judge, FindsNothingInSolids) {
  for (const Mesh& mesh :
       {box({1, 2, 3}), tetrahedron(), sphere(0.3, 20), torus(0.5, 0.2, 20), joined(box({1, 1, 1}), box({1, 1, 1}), Vec3(1, 0, 0)),
        joined(box({3, 3, 3}), inside_out(box({1, 1, 1})), Vec3(1, 1, 1))}) {
    EXPECT_THAT(sentences(judge(mesh)), IsEmpty());
    EXPECT_NO_THROW(require_solid(mesh, "pump"));
  }
}

TEST(Judge, NamesTheEdgesOfATriangleThatWasRemoved) {
  constexpr std::uint64_t seed = 3;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int i = 0; i < 100; ++i) {
    Mesh mesh = torus(0.5, 0.2, 8);
    const auto removed = static_cast<std::ptrdiff_t>(random() % mesh.triangles.size());
    const Triangle hole = mesh.triangles[static_cast<std::size_t>(removed)];
    mesh.triangles.erase(mesh.triangles.begin() + removed);
    EXPECT_THAT(counts_of(mesh), ElementsAre(3, 0, 0, 0, 0, 0, 0));
    const EdgePlace edge = judge(mesh).open_edges.first;
    EXPECT_THAT(hole, testing::IsSupersetOf(edge.vertices));
    EXPECT_EQ(edge.ends_m[0], mesh.vertices_m[edge.vertices[0]]);
    EXPECT_THAT(mesh.triangles[edge.triangles[0]], testing::IsSupersetOf(edge.vertices));
  }
}

TEST(Judge, NamesATriangleThatWasTurnedOver) {
  constexpr std::uint64_t seed = 4;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int i = 0; i < 100; ++i) {
    Mesh mesh = sphere(0.3, 8);
    const std::size_t turned = random() % mesh.triangles.size();
    std::swap(mesh.triangles[turned][0], mesh.triangles[turned][1]);
    EXPECT_THAT(counts_of(mesh), ElementsAre(0, 0, 3, 0, 0, 0, 0));
    EXPECT_THAT(judge(mesh).inconsistent_edges.first.triangles, testing::Contains(turned));
  }
}

TEST(Judge, NamesATriangleThatIsThereTwice) {
  for (const bool is_turned : {false, true}) {
    Mesh mesh = sphere(0.3, 8);
    const Triangle t = mesh.triangles[17];
    mesh.triangles.push_back(is_turned ? Triangle{t[1], t[0], t[2]} : Triangle{t[1], t[2], t[0]});
    EXPECT_THAT(counts_of(mesh), ElementsAre(0, 0, 0, 0, 0, 1, 0)) << "and its edges are not told, too";
    EXPECT_EQ(judge(mesh).duplicates.first.triangle, mesh.triangles.size() - 1);
    EXPECT_EQ(judge(mesh).duplicates.first.corners_m[2], mesh.vertices_m[t[is_turned ? 2 : 0]]);
  }
}

TEST(Judge, NamesAnInnerFaceByItsEdges) {
  // Two boxes with a common face: the wall between them is in the mesh.
  Mesh mesh = joined(box({1, 1, 1}), box({1, 1, 1}), Vec3(1, 0, 0));
  merge_vertices(mesh);
  EXPECT_THAT(counts_of(mesh), ElementsAre(0, 4, 0, 0, 0, 2, 0));
  EXPECT_EQ(judge(mesh).crowded_edges.first.ends_m[0].x(), 1);
}

TEST(Judge, NamesTrianglesWithoutArea) {
  Mesh mesh = box({1, 1, 1});
  mesh.triangles.push_back({3, 3, 5});
  EXPECT_THAT(counts_of(mesh), ElementsAre(0, 0, 0, 0, 1, 0, 0));
  EXPECT_EQ(judge(mesh).degenerate.first.triangle, 12U);
  // A vertex in the middle of an edge: closed, with one triangle flat.
  mesh = tetrahedron();
  mesh.vertices_m.emplace_back(0.5, 0, 0);
  mesh.triangles = {{0, 2, 4}, {4, 2, 1}, {0, 1, 3}, {0, 4, 1}, {1, 2, 3}, {0, 3, 2}};
  EXPECT_THAT(counts_of(mesh), ElementsAre(0, 0, 0, 0, 1, 0, 0));
  EXPECT_EQ(judge(mesh).degenerate.first.triangle, 3U);
  // A height of 1e-6 of the length is none too small.
  mesh.vertices_m[4].y() = -1e-6;
  EXPECT_THAT(counts_of(mesh), ElementsAre(0, 0, 0, 0, 0, 0, 0));
}

TEST(Judge, NamesShellsThatAreInsideOut) {
  EXPECT_THAT(counts_of(inside_out(torus(0.5, 0.2, 8))), ElementsAre(0, 0, 0, 1, 0, 0, 0));
  // Of three in a row the one in the middle, which the sum of the volumes does not tell.
  const Mesh row = joined(joined(box({1, 1, 1}), box({1, 1, 1}), Vec3(4, 0, 0)), inside_out(box({1, 1, 1})), Vec3(2, 0, 0));
  EXPECT_THAT(counts_of(row), ElementsAre(0, 0, 0, 1, 0, 0, 0));
  EXPECT_EQ(judge(row).inside_out_shells.first.triangle, 24U);
  EXPECT_THAT(counts_of(joined(inside_out(box({3, 3, 3})), box({1, 1, 1}), Vec3(1, 1, 1))), ElementsAre(0, 0, 0, 1, 0, 0, 0));
  // Folded flat: two squares back to back, with different diagonals.
  EXPECT_THAT(counts_of({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}}),
              ElementsAre(0, 0, 0, 1, 0, 0, 0));
}

TEST(Judge, NamesVerticesOfNoTriangle) {
  Mesh mesh = tetrahedron();
  mesh.vertices_m.emplace_back(7, 8, 9);
  EXPECT_THAT(counts_of(mesh), ElementsAre(0, 0, 0, 0, 0, 0, 1));
  EXPECT_EQ(judge(mesh).unused_vertices.first.vertex, 4U);
  EXPECT_THAT(sentences(judge(mesh)), ElementsAre("1 vertex is in no triangle, at (7, 8, 9): remove loose vertices in a mesh editor"));
}

TEST(Judge, TellsEdgesThatAreOnlyNotMerged) {
  Mesh mesh;
  for (const Triangle& t : tetrahedron().triangles)
    mesh = joined(mesh, {{tetrahedron().vertices_m[t[0]], tetrahedron().vertices_m[t[1]], tetrahedron().vertices_m[t[2]]}, {{0, 1, 2}}});
  EXPECT_THAT(counts_of(mesh), ElementsAre(12, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(
      sentences(judge(mesh)),
      ElementsAre(
          "12 edges are open, the first from (0, 0, 0) to (0, 1, 0) of triangle 1; 12 of them lie upon each other: merge vertices by "
          "distance in a mesh editor"));
  merge_vertices(mesh);
  EXPECT_THAT(counts_of(mesh), ElementsAre(0, 0, 0, 0, 0, 0, 0));
}

TEST(RequireSolid, RefusesAnEmptyMesh) {
  EXPECT_FALSE(judge({}).any());
  EXPECT_EQ(lf::test::message_of<InputError>([] { require_solid({}, "pump"); }), "pump: has no triangles: export the mesh anew");
}

// Their shells are not compared one by one.
TEST(Judge, BearsManyShells) {
  Mesh mesh = box({1, 1, 1});
  const Mesh one = box({0.5, 0.5, 0.5});
  for (int i = 1; i < 2100; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    for (const Vec3& vertex : one.vertices_m) mesh.vertices_m.push_back(vertex + Vec3(i, 0, 0));
    for (const Triangle& t : one.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  EXPECT_EQ(measure(mesh).shells, 2100U);
  EXPECT_FALSE(judge(mesh).any());
  EXPECT_EQ(judge(inside_out(mesh)).inside_out_shells.count, 2100U);
}

TEST(RequireSolid, TellsAllFaultsAtOnceWithTheRemedies) {
  Mesh mesh = joined(box({1, 1, 1}), inside_out(tetrahedron()), Vec3(5, 0, 0));
  mesh.triangles[13] = {mesh.triangles[13][1], mesh.triangles[13][0], mesh.triangles[13][2]};
  mesh.triangles.erase(mesh.triangles.begin());
  mesh.triangles.push_back({2, 2, 3});
  mesh.triangles.push_back(mesh.triangles[4]);
  mesh.vertices_m.emplace_back(0.5, 0, 0);
  mesh.triangles.push_back({0, 1, 6});
  EXPECT_EQ(lf::test::message_of<InputError>([&] { require_solid(mesh, "pump"); }),
            "pump: 4 edges are open, the first from (0, 1, 0) to (0, 0, 0) of triangle 9: fill the holes in a mesh editor\n"
            "pump: 2 edges are shared by more than two triangles, the first from (1, 0, 0) to (0, 0, 0) of triangles 1 and 18 among "
            "others: remove inner "
            "faces, or part bodies that touch, in a mesh editor\n"
            "pump: 3 edges are between triangles that turn in opposite senses, the first from (5, 0, 0) to (6, 0, 0) of triangles 12 and "
            "13: recalculate the "
            "normals in a mesh editor\n"
            "pump: 1 triangle is without area, triangle 16 with the corners (0, 1, 0), (0, 1, 0), (1, 1, 0): dissolve degenerate faces in "
            "a mesh editor\n"
            "pump: 1 triangle repeats an earlier one, triangle 17 with the corners (0, 0, 0), (1, 0, 1), (0, 0, 1): remove double faces in "
            "a mesh editor\n"
            "pump: 1 vertex is in no triangle, at (0.5, 0, 0): remove loose vertices in a mesh editor");
}

}  // namespace
}  // namespace lf::mesh::test
