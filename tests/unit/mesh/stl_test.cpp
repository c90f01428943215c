// STL, text and binary, as programs write it.
#include "tests/unit/mesh/readings.hpp"

namespace lf::mesh::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Ten lines; the facet in line 2.
const std::string one_facet =
    "solid a part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a part\n";

Mesh read(const std::string& bytes) { return parse_mesh("a.stl", bytes).mesh; }

// The order in which corners come first.
Mesh by_corners(const Mesh& mesh) {
  Mesh soup;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices_m.size());
    for (const std::uint32_t corner : t) soup.vertices_m.push_back(mesh.vertices_m[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  merge_vertices(soup);
  return soup;
}

TEST(Stl, TextAndBinaryMergeVerticesByTheirExactPlace) {
  const Mesh cube = by_corners(box({1, 2, 3}));
  ASSERT_EQ(cube.vertices_m.size(), 8U);
  expect_same(read(text_stl_of(box({1, 2, 3}))), cube);
  expect_same(read(binary_stl_of(box({1, 2, 3}))), cube);
  Mesh apart = joined(tetrahedron(), tetrahedron(), Vec3(1e-7, 0, 0));
  EXPECT_EQ(read(text_stl_of(apart)).vertices_m.size(), 8U) << "close is not the same";
  apart = joined(tetrahedron(), tetrahedron());
  apart.vertices_m[0] = Vec3(-0.0, 0, -0.0);
  EXPECT_EQ(read(binary_stl_of(apart)).vertices_m.size(), 4U) << "0 and -0 are";
}

TEST(Stl, BinaryMayBeginWithSolid) {
  for (const char* header : {"solid", "solid made by a program", "solid a\nfacet normal 0 0 1\n"})
    EXPECT_EQ(read(binary_stl_of(box({1, 1, 1}), header)).triangles.size(), 12U) << header;
}

TEST(Stl, WhoseCountAndSizeDisagreeAreRefused) {
  const std::string bytes = binary_stl_of(tetrahedron());
  const auto counting = [&](std::uint32_t count) { return bytes.substr(0, 80) + bytes_of(count) + bytes.substr(84); };
  expect_refused("a.stl",
                 {{counting(3), ": says 3 triangles, which makes 234 bytes, but has 284: it was cut off, or is damaged; export it anew"},
                  {counting(5), ": says 5 triangles, which makes 334 bytes, but has 284"},
                  {counting(0), ": says 0 triangles, which makes 84 bytes, but has 284"},
                  {counting(0xFFFFFFFF), ": has 4294967295 triangles or more; 2000000 are read: decimate it in a mesh editor"},
                  {bytes.substr(0, 80) + bytes_of(std::uint32_t{0}), ": has no triangles"},
                  {"made", ": is neither text nor a binary STL: that has a header of 84 bytes, this file 4 bytes"}});
}

TEST(Stl, CoordinatesThatAreNotFiniteAreRefused) {
  for (const float value : {std::nanf(""), HUGE_VALF, -HUGE_VALF, 2e12f}) {
    std::string bytes = binary_stl_of(tetrahedron());
    bytes.replace(84 + 50 + 12 + 24, 4, bytes_of(value));  // the second triangle's third corner
    EXPECT_THAT(error_of("a.stl", bytes), testing::StartsWith("a.stl: triangle 2 has the coordinate ")) << value;
  }
  expect_refused("a.stl", {{with(one_facet, "1 0 0", "1 nan 0"), ":5: a vertex has the coordinate 'nan': it has to be finite"},
                           {with(one_facet, "1 0 0", "1 inf 0"), ":5: a vertex has the coordinate 'inf'"},
                           {with(one_facet, "1 0 0", "1 O 0"), ":5: a vertex has 'O', which is no number"}});
}

TEST(Stl, TextMayBeInCapitalsOnOneLineAndWithoutNames) {
  const Mesh expected = read(one_facet);
  ASSERT_EQ(expected.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  expect_same(
      read("SOLID\r\nFACET NORMAL 0 0 1\r\nOUTER LOOP\r\nVERTEX 0 0 0\r\nVERTEX 1 0 0\r\nVERTEX 0 1 0\r\nENDLOOP\r\nENDFACET\r\nENDSOLID"),
      expected);
  expect_same(read("\n solid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet endsolid"), expected);
  expect_same(read(with(one_facet, "vertex 1 0 0", "vertex 1.0e+00 0 -0")), expected);
}

TEST(Stl, SolidsOfOneFileAreMergedAndTold) {
  const Reading reading = parse_mesh("a.stl", one_facet + with(one_facet, "1 0 0", "0 0 1"));
  EXPECT_EQ(reading.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 3, 2}}));
  EXPECT_THAT(notes_of(reading), testing::Contains("0: its 2 solids are merged into one mesh"));
}

TEST(Stl, TextThatIsDamagedIsRefusedWithItsLine) {
  expect_refused("a.stl", {{with(one_facet, "endloop", "vertex 1 1 0\nendloop"),
                            ":7: a facet has a fourth vertex: STL has triangles; triangulate it when exporting"},
                           {with(one_facet, "vertex 0 1 0\n", ""), ":6: has 'endloop' where 'vertex' has to stand: it is damaged"},
                           {with(one_facet, "endfacet\n", ""), ":8: has 'endsolid' where 'endfacet' has to stand"},
                           {with(one_facet, "outer loop\n", ""), ":3: has 'vertex' where 'outer' has to stand"},
                           {with(one_facet, "normal 0 0 1", "normal 0 0"), ":3: has 'outer' where 'a number of the normal' has to stand"},
                           {with(one_facet, "endsolid a part\n", ""), ":8: ends where 'facet or endsolid' has to stand: it was cut off"},
                           {one_facet + "v 0 0 0\n", ":10: has 'v' where 'solid' has to stand"},
                           {with(one_facet, "solid a part\n", "solid a part "),
                            ":1: has a facet in the line of a solid's name: begin it in a line of its own"},
                           {"solid nothing\nendsolid\n", ": has no triangles"}});
}

TEST(Stl, NormalsAgainstTheWindingAreTold) {
  EXPECT_THAT(notes_of(parse_mesh("a.stl", one_facet)), IsEmpty());
  EXPECT_THAT(notes_of(parse_mesh("a.stl", with(one_facet, "0 0 1", "0 0 0"))), IsEmpty());
  EXPECT_THAT(notes_of(parse_mesh("a.stl", with(one_facet, "0 0 1", "0 0 -1"))),
              ElementsAre("2: the normal of triangle 1 does not agree with the order of its corners, which is what counts here"));
  EXPECT_THAT(notes_of(parse_mesh("a.stl", with(one_facet, "0 0 1", "-nan(ind) nan 0"))), testing::SizeIs(1));
}

TEST(Stl, AttributesAreTold) {
  std::string bytes = binary_stl_of(tetrahedron());
  bytes.back() = '\x7f';
  EXPECT_THAT(notes_of(parse_mesh("a.stl", bytes)), ElementsAre("0: not used: its triangles' attributes (colours)"));
}

}  // namespace
}  // namespace lf::mesh::test
