// PLY, text and binary, as programs write it.
#include "tests/unit/mesh/readings.hpp"

namespace lf::mesh::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

Mesh read(const std::string& bytes) { return parse_mesh("a.ply", bytes).mesh; }

// The header ends with line 9.
const std::string text = text_ply_of(tetrahedron());

TEST(Ply, AllEncodingsAreReadExactly) {
  const Mesh ball = sphere(0.1, 7);
  for (const std::string& bytes : {text_ply_of(ball), binary_ply_of(ball, false), binary_ply_of(ball, true)}) {
    const Reading reading = parse_mesh("a.ply", bytes);
    expect_same(reading.mesh, ball);
    EXPECT_THAT(notes_of(reading), IsEmpty());
  }
}

// All types, and lists of them, before, between and behind what is used.
std::string rich_ply(bool is_big_endian) {
  std::string bytes =
      std::string("ply\nformat binary_") + (is_big_endian ? "big" : "little") +
      "_endian 1.0\ncomment made by hand\nobj_info of no use\nelement camera 1\nproperty float64 fov\nproperty list int16 float32 view\n"
      "element vertex 4\nproperty uchar red\nproperty float x\nproperty list uint8 ushort tags\nproperty short y\nproperty double z\n"
      "property int flags\nelement face 2\nproperty uchar red\nproperty list uint ushort vertex_index\nproperty list char double uv\n"
      "element edge 1\nproperty uint32 a\nproperty int8 b\nend_header\n";
  const auto put = [&](auto number) { bytes += bytes_of(number, is_big_endian); };
  put(1.5), put(std::int16_t{2}), put(1.f), put(2.f);
  for (int i = 0; i < 4; ++i) {
    put(std::uint8_t{255}), put(static_cast<float>(i & 1) / 2), put(std::uint8_t{2}), put(std::uint16_t{7}), put(std::uint16_t{8});
    put(static_cast<std::int16_t>(i >> 1)), put(-0.25), put(std::int32_t{-1});
  }
  put(std::uint8_t{1}), put(std::uint32_t{4});
  for (const int corner : {0, 1, 3, 2}) put(static_cast<std::uint16_t>(corner));
  put(std::int8_t{1}), put(0.5);
  put(std::uint8_t{1}), put(std::uint32_t{3});
  for (const int corner : {2, 1, 0}) put(static_cast<std::uint16_t>(corner));
  put(std::int8_t{0});
  put(std::uint32_t{1}), put(std::int8_t{-1});
  return bytes;
}

TEST(Ply, FurtherPropertiesAndElementsOfAnyTypeAreToldAndPassedOver) {
  for (const bool is_big_endian : {false, true}) {
    const Reading reading = parse_mesh("a.ply", rich_ply(is_big_endian));
    expect_same(reading.mesh, {{{0, 0, -0.25}, {0.5, 0, -0.25}, {0, 1, -0.25}, {0.5, 1, -0.25}}, {{0, 1, 3}, {0, 3, 2}, {2, 1, 0}}});
    EXPECT_THAT(notes_of(reading), ElementsAre("5: not used: the element 'camera'", "8: not used: 'red, tags, flags' of its vertices",
                                               "15: not used: 'red, uv' of its faces", "19: not used: the element 'edge'"));
  }
}

TEST(Ply, FacesMayComeFirstAndHaveFourCorners) {
  expect_same(read("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar uint vertex_indices\nelement vertex 4\nproperty float "
                   "x\nproperty float y\n"
                   "property float z\nend_header\n4 0 1 2 3\n0 0 0\n1 0 0\n\n1 1 0\r\n0 1 0\n\n"),
              {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  expect_refused(
      "a.ply", {{with(with(with(text, "face 4", "face 1"), "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n", "4 0 1 2 3\n"), "0 0 0\n", "0 0 0.5\n"),
                 ":14: face 1 of 4 corners is not planar: triangulate it"}});
}

TEST(Ply, TextThatIsDamagedIsRefusedWithItsLine) {
  expect_refused("a.ply", {{with(text, "3 0 1 3", "3 0 1 4"), ":15: face 2 has vertex 4, but the file has 4 vertices, counted from 0"},
                           {with(text, "3 0 1 3", "3 0 1 -1"), ":15: a face's index of a vertex is -1: it has to be a whole number"},
                           {with(text, "3 0 1 3", "3 0 1 1.5"), ":15: a face's index of a vertex is 1.5"},
                           {with(text, "3 0 1 3", "3 0 1 5e9"), ":15: a face's index of a vertex is 5e+09"},
                           {with(text, "3 0 1 3", "-3 0 1 3"), ":15: the count of a list is -3"},
                           {with(text, "3 0 1 3", "2 0 1"), ":15: face 2 has 2 corners: it needs three"},
                           {with(text, "3 0 1 3", "3 0 1"), ":15: has too few numbers for its element's properties"},
                           {with(text, "3 0 1 3", "3 0 1 3 9"), ":15: has '9' behind its element's properties"},
                           {with(text, "1 0 0", "1 0 nan"), ":11: a vertex has the coordinate nan: it has to be finite"},
                           {with(text, "1 0 0", "1 inf 0"), ":11: a vertex has the coordinate inf"},
                           {with(text, "1 0 0", "1 0 x"), ":11: has 'x', which is no number"},
                           {with(text, "3 0 3 2\n", ""), ":16: ends before its last 'face': it was cut off; export it anew"},
                           {text + "3 0 1 2\n", ":18: follows what the header counts"}});
}

TEST(Ply, BinaryThatIsDamagedIsRefused) {
  const std::string bytes = binary_ply_of(tetrahedron(), true);
  expect_refused("a.ply", {{bytes + "x", ": has 1 byte behind what its header counts: it is damaged"},
                           {bytes.substr(0, bytes.size() - 1), ": ends in its last 'face': it was cut off"},
                           {bytes.substr(0, bytes.size() - 4) + bytes_of(std::int32_t{-2}, true),
                            ": a face's index of a vertex is -2 after 4 vertices and 3 faces"},
                           {bytes.substr(0, bytes.size() - 13) + "\xff" + bytes.substr(bytes.size() - 12), ": ends in its last 'face'"}});
  std::string wrong = bytes;
  wrong.replace(wrong.find("end_header\n") + 11, 8, bytes_of(std::nan(""), true));
  EXPECT_THAT(error_of("a.ply", wrong), StartsWith("a.ply: a vertex has the coordinate nan after 0 vertices and 0 faces"));
}

TEST(Ply, CountsBeyondTheFileOrTheBoundAreRefusedBeforeMemoryIsTaken) {
  for (const std::string encoding : {"ascii", "binary_little_endian"}) {
    expect_refused("a.ply", {{ply_header(encoding, 4'000'000'000, 1),
                              ":3: says 4000000000 of element 'vertex', but only 0 bytes follow its header: it was cut off"},
                             {ply_header(encoding, 0, 9'223'372'036'854'775'807), ":7: says 9223372036854775807 of element 'face'"}});
  }
  std::string long_list =
      with(ply_header("binary_little_endian", 1, 1), "uchar int", "uint int") + std::string(24, '\0') + bytes_of(std::uint32_t{0xFFFFFFFF});
  EXPECT_THAT(error_of("a.ply", long_list), StartsWith("a.ply: ends in its last 'face'"));
  EXPECT_THAT(error_of("a.ply", ply_header("binary_little_endian", 0, 2'000'001) + std::string(2'000'001, '\0')),
              StartsWith("a.ply:7: has 2000001 triangles or more; 2000000 are read: decimate it"));
  const std::string bytes_vertices =
      "ply\nformat binary_little_endian 1.0\nelement vertex 6000001\nproperty char x\nproperty char y\nproperty char z\nelement face 1\n"
      "property list uchar uchar vertex_indices\nend_header\n";
  EXPECT_THAT(error_of("a.ply", bytes_vertices + std::string(18'000'004, '\0')),
              StartsWith("a.ply:3: has 6000001 vertices or more; 6000000 are read"));
}

TEST(Ply, HeadersThatAreNoneAreRefusedWithTheirLine) {
  expect_refused(
      "a.ply",
      {{with(text, "ascii 1.0", "ascii 2.0"), ":2: has version '2.0': this reader knows 1.0"},
       {with(text, "ascii", "binary"), ":2: has the format 'binary': it has to be ascii, binary_little_endian or binary_big_endian"},
       {with(text, "format ascii 1.0\n", ""), ":8: states no format"},
       {with(text, "format ascii 1.0\n", "format ascii 1.0\nformat ascii 1.0\n"), ":3: states its format a second time"},
       {with(text, "format ascii 1.0\n", "format ascii 1.0\nproperty float q\n"), ":3: has a property before any element"},
       {with(text, "double x", "half x"), ":4: has a property of type 'half': PLY has char"},
       {with(text, "double x", "double"), ":4: has a property without a name"},
       {with(text, "double y", "double x"), ":5: has the property 'x' a second time"},
       {with(text, "element face", "element vertex"), ":7: has the element 'vertex' a second time"},
       {with(text, "double z", "double w"), ":3: has vertices without the number z"},
       {with(text, "element vertex 4", "element vertex -4"), ":3: an element needs a name and a count"},
       {with(text, "element vertex 4", "element vertex four"), ":3: an element needs a name and a count"},
       {with(text, "element vertex 4", "element vertex 4 5"), ":3: has '5' behind what the line says"},
       {with(text, "uchar int vertex_indices", "float int vertex_indices"), ":8: counts a list with a type that is not whole"},
       {with(text, "uchar int vertex_indices", "uchar float vertex_indices"),
        ":7: has a 'vertex_indices' that is no list of whole numbers"},
       {with(text, "vertex_indices", "corners"), ":7: has faces with 0 lists of their vertices"},
       {with(text, "element face", "element tristrips"), ":7: has strips of triangles (tristrips): export the mesh as faces"},
       {with(text, "element face", "element patch"), ": has no faces: is it a cloud of points? Export a mesh"},
       {with(text, "element vertex", "element point"), ": has no element 'vertex'"},
       {with(text, "end_header", "element empty 3\nend_header"), ":9: has the element 'empty' without a property"},
       {with(text, "end_header", "hello\nend_header"), ":9: has 'hello' in its header, which PLY has not"},
       {with(text, "ply\n", "play\n"), ": does not begin with 'ply'"}});
}

}  // namespace
}  // namespace lf::mesh::test
