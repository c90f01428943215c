// OBJ as programs and people write it.
#include "tests/unit/mesh/readings.hpp"

namespace lf::mesh::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Four vertices, lines 1 to 4.
const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Mesh read(const std::string& text) { return parse_mesh("a.obj", text).mesh; }
std::vector<std::string> notes(const std::string& text) { return notes_of(parse_mesh("a.obj", text)); }

TEST(Obj, IsReadExactly) {
  const Mesh ball = sphere(0.1, 7);
  const Reading reading = parse_mesh("a.obj", obj_of(ball));
  expect_same(reading.mesh, ball);
  EXPECT_THAT(notes_of(reading), IsEmpty());
  EXPECT_EQ(reading.told(reading.notes[0]), "a.obj: states no unit and no axes: its numbers are taken as metres, and its axes as they are");
}

TEST(Obj, NegativeIndicesCountBackwardsFromWhereTheyStand) {
  expect_same(read(corners + "f -4 -2 -3\nv 5 5 5\nf -5 -4 -2\n"),
              {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 5, 5}}, {{0, 2, 1}, {0, 1, 3}}});
  expect_refused("a.obj", {{corners + "f -5 -4 -2\n", ":5: a face has vertex -5, counted backwards, but there are 4 vertices before it"}});
}

TEST(Obj, CornersMayHaveTextureCoordinatesAndNormals) {
  for (const char* face :
       {"f 1 2 3", "f 1/1 2/2 3/3", "f 1//1 2//1 3//1", "f 1/1/1 2/2/1 3/3/1", "f -4/-3/-1 -3/-2/-1 -2/-1/-1", "f 1 2 3 # a comment"})
    EXPECT_EQ(read(corners + "vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n" + face + "\n").triangles, (std::vector<Triangle>{{0, 1, 2}})) << face;
  for (const char* face : {"f 1/ 2/ 3/", "f 1// 2// 3//", "f 1/1/1/1 2 3", "f a 2 3", "f 1.5 2 3", "f 1,2,3", "f 1/x 2 3"})
    EXPECT_THAT(error_of("a.obj", corners + face + "\n"), HasSubstr("a.obj:5: a face has the corner '")) << face;
}

TEST(Obj, FacesMayStandBeforeTheirVertices) { EXPECT_EQ(read("f 1 2 3\n" + corners).triangles, (std::vector<Triangle>{{0, 1, 2}})); }

TEST(Obj, IndicesOutOfRangeAreRefusedWithTheirLine) {
  expect_refused("a.obj", {{corners + "f 1 2 5\n", ":5: face 1 has vertex 5, but the file has 4 vertices, counted from 1: export it anew"},
                           {corners + "f 1 2 3\nf 0 1 2\n", ":6: a face has vertex 0: OBJ counts from 1"},
                           {corners + "f 1 2 4294967297\n", ":5: a face has vertex 4294967297, and no file has so many"},
                           {corners + "f 1 2 99999999999999999999\n", ":5: a face has the corner '99999999999999999999'"},
                           {corners + "f 1 2\n", ":5: face 1 has 2 corners: it needs three"},
                           {corners + "f\n", ":5: face 1 has 0 corners"}});
}

TEST(Obj, PlanarConvexFacesBecomeFans) {
  EXPECT_EQ(read(square + "f 1 2 3 4\n").triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(read(square + "f 4 3 2 1\n").triangles, (std::vector<Triangle>{{3, 2, 1}, {3, 1, 0}})) << "with its own sense of turning";
  for (const std::size_t n : {30U, 512U, 2000U}) {
    std::string ring, face = "f";
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 2 * pi * static_cast<double>(i) / static_cast<double>(n);
      ring += "v " + exact(Vec3(3 + std::cos(angle), std::sin(angle), 0.3)) + "\n";
      face += " " + std::to_string(i + 1);
    }
    EXPECT_EQ(read(ring + face + "\n").triangles.size(), n - 2);
  }
  EXPECT_EQ(read("v 0 0 0\nv 1 0 0\nv 1 0.00005 0\nv 0 0.00005 0\nf 1 2 3 4\n").triangles.size(), 2U) << "the edge of a thin sheet";
}

// A T-junction's vertex, or an edge that a neighbour has divided.
TEST(Obj, CornersOnAStraightLineMakeNoTriangleWithoutArea) {
  const auto twice_area = [](const Mesh& mesh, const Triangle& t) {
    return (mesh.vertices_m[t[1]] - mesh.vertices_m[t[0]]).cross(mesh.vertices_m[t[2]] - mesh.vertices_m[t[0]]).z();
  };
  const std::string halves = square + "v 0.5 0 0\nv 1 0.5 0\nv 0.5 1 0\nv 0 0.5 0\n";
  for (const char* face : {"f 1 5 2 3 4", "f 5 2 3 4 1", "f 1 2 3 4 8", "f 1 5 2 6 3 7 4 8", "f 1 5 2 3"}) {
    const Mesh mesh = read(halves + face + "\n");
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
      EXPECT_GT(twice_area(mesh, t), 0.1) << face;
      sum += twice_area(mesh, t);
    }
    EXPECT_NEAR(sum, std::string(face) == "f 1 5 2 3" ? 1 : 2, 1e-12) << face;
  }
  expect_refused(
      "a.obj",
      {{"v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 1.5 3 0\nv 0.75 1.5 0\nv 2.25 1.5 0\nv 0.3 0.6 0\nv 2.6 0.8 0\nf 1 2 3 4 9 7 5 6 8\n",
        ":10: face 1 of 9 corners has its corners on straight lines, so that triangles would have no area: triangulate it"}});
}

TEST(Obj, OtherFacesAreRefusedWithTheirLine) {
  const std::string remedy = ": triangulate it when exporting, or in a mesh editor";
  expect_refused("a.obj", {{"v 0 0 0\nv 1 0 0\nv 1 1 0.01\nv 0 1 0\nf 1 2 3 4\n", ":5: face 1 of 4 corners is not planar" + remedy},
                           {"v 0 0 0\nv 1 0 0\nv 0.2 0.2 0\nv 0 1 0\nf 1 2 3 4\n", ":5: face 1 of 4 corners is not convex" + remedy},
                           {square + "f 1 3 2 4\n", ":5: face 1 of 4 corners has no area" + remedy},
                           {"v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 2 0\nf 1 3 2 4\n", ":5: face 1 of 4 corners is not convex" + remedy},
                           {square + "f 1 2 2 3\n", ":5: face 1 of 4 corners is not convex" + remedy},
                           {"v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n", ":5: face 1 of 4 corners has no area" + remedy}});
  std::string star;
  for (int i = 0; i < 5; ++i) star += "v " + exact(Vec3(std::cos(4 * pi * i / 5), std::sin(4 * pi * i / 5), 0)) + "\n";
  expect_refused("a.obj", {{star + "f 1 2 3 4 5\n", ":6: face 1 of 5 corners crosses itself" + remedy}});
}

// Six digits after the point, as most programs write, at a metre from the origin.
TEST(Obj, FacesAreAsPlanarAsTheirDigits) {
  EXPECT_EQ(read("v 1.000000 1.000000 0.500001\nv 1.002000 1.000000 0.500000\nv 1.002000 1.002000 0.500001\nv 1.000000 1.002000 "
                 "0.500000\nf 1 2 3 4\n")
                .triangles.size(),
            2U);
}

TEST(Obj, GroupsAndObjectsAreMergedAndTold) {
  const std::string text = "o lid\n" + corners + "g a b\nf 1 2 3\no hull\ng c\nf 1 2 4\n";
  EXPECT_EQ(read(text).triangles.size(), 2U);
  EXPECT_THAT(notes(text), ElementsAre("0: its 2 objects (o) and 2 groups (g) are merged into one mesh"));
  EXPECT_THAT(notes("o lid\ng lid\n" + corners + "f 1 2 3\n"), IsEmpty());
}

TEST(Obj, WhatIsNotUsedIsToldOnceWithItsLine) {
  EXPECT_THAT(notes("mtllib a.mtl\n" + corners + "vt 0 0\nvn 0 0 1\nusemtl red\ns off\nf 1 2 3\nusemtl blue\nl 1 2\np 3\n"),
              ElementsAre("1: not used: a library of materials (mtllib)", "6: not used: texture coordinates (vt)",
                          "7: not used: normals (vn)", "8: not used: materials (usemtl)", "9: not used: smoothing groups (s)",
                          "12: not used: lines (l)", "13: not used: points (p)"));
  EXPECT_THAT(notes("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n"), ElementsAre("1: not used: weights of vertices"));
  EXPECT_THAT(notes("v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n"), ElementsAre("1: not used: colours of vertices"));
}

TEST(Obj, WhatIsUnknownIsRefused) {
  expect_refused("a.obj",
                 {{corners + "hello world\n", ":5: begins with 'hello', which is no statement of an OBJ file"},
                  {corners + "cstype bezier\n", ":5: has 'cstype' of a free-form curve or surface: export the mesh as polygons"},
                  {corners + "v 1 2\n", ":5: a vertex lacks a coordinate"},
                  {corners + "v 1 2 3 4 5\n", ":5: a vertex has 5 numbers"},
                  {corners + "v 1 2 3 4 5 6 7 8\n", ":5: a vertex has 8 numbers"},
                  {corners + "v 1 2 3 red\n", ":5: a vertex has 'red', which is no number"},
                  {corners + "v 1 2 3x\n", ":5: a vertex has '3x', which is no number: correct it"},
                  {corners + "v 1 2 3,5\n", ":5: a vertex has '3,5', which is no number: write a decimal point in place of the comma"},
                  {corners, ": has no triangles: was the file cut off, or is it a cloud of points?"},
                  {"f 1 2 3\n", ":1: face 1 has vertex 1, but the file has 0 vertices"}});
}

TEST(Obj, NumbersThatAreNotFiniteAreRefused) {
  for (const char* word : {"nan", "-nan", "NaN", "inf", "-inf", "Infinity", "1e13", "-2e300"})
    EXPECT_THAT(
        error_of("a.obj", corners + "v 1 " + word + " 2\n"),
        testing::StartsWith(std::string("a.obj:5: a vertex has the coordinate '") + word + "': it has to be finite, and below 1e12"));
  EXPECT_THAT(error_of("a.obj", corners + "v 1 1e999 2\n"), HasSubstr("a.obj:5: a vertex has '1e999', which is no number"));
}

TEST(Obj, LinesMayEndAsOnWindowsBeCommentsOrBeContinued) {
  const Mesh expected = read(corners + "f 1 2 3\nf 1 2 4\n");
  expect_same(read("# made\r\n\r\nv 0 0 0\r\nv 1 0 0\r\n  v\t0 1 0 # third\r\nv 0 0 +1\r\nf 1 2 3\r\nf 1 2 4\r\n"), expected);
  expect_same(read(corners + "f 1 \\\n2\\\r\n3\nf 1 2 4\n"), expected);
  expect_same(read("# in C:\\models\\\n" + corners + "f 1 2 3\nf 1 2 4\n"), expected);
  expect_same(read("\xEF\xBB\xBF" + corners + "f 1 2 3\nf 1 2 4\n"), expected);
  expect_refused("a.obj", {{corners + "f 1 2 \\\n9\n", ":5: face 1 has vertex 9"},
                           {corners + "f 1 2 3\nf 1 2 4\\", ":6: ends with a backslash, which continues a line: it was cut off"},
                           {corners + std::string("f 1 2 \0003\n", 9), ":5: holds a byte 0, which no text has"}});
}

TEST(Obj, ALastLineWithoutItsEndIsTold) {
  EXPECT_THAT(notes(corners + "f 1 2 3"), ElementsAre("5: has no end of line, and is the last: was it cut off?"));
}

}  // namespace
}  // namespace lf::mesh::test
