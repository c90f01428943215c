// What a reader makes of bytes.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "shared/input_error.hpp"
#include "shared/mesh/read_mesh.hpp"
#include "tests/unit/mesh/solids.hpp"

namespace lf::mesh::test {

// "a.obj:3: ..."; "" when the bytes are read.
inline std::string error_of(const std::string& file, const std::string& bytes, const Vec3& scale = Vec3::Ones()) {
  try {
    (void)parse_mesh(file, bytes, scale);
  } catch (const InputError& refused) {
    return refused.what();
  }
  return "";
}

// "3: ...", but for the one on unit and axes, which every mesh has.
inline std::vector<std::string> notes_of(const Reading& reading) {
  std::vector<std::string> notes;
  for (const Note& note : reading.notes)
    if (!note.text.starts_with("states no unit")) notes.push_back(std::to_string(note.line) + ": " + note.text);
  return notes;
}

inline void expect_same(const Mesh& mesh, const Mesh& expected) {
  EXPECT_EQ(mesh.vertices_m, expected.vertices_m);
  EXPECT_EQ(mesh.triangles, expected.triangles);
}

struct Refused {
  std::string bytes;
  std::string error;  // begins so
};
inline void expect_refused(const std::string& file, const std::vector<Refused>& cases) {
  for (const Refused& c : cases) {
    const std::string error = error_of(file, c.bytes);
    EXPECT_THAT(error, testing::StartsWith(file + c.error)) << c.bytes;
    EXPECT_THAT(error, testing::Not(testing::HasSubstr("\n")));
  }
}

// `text` with the first `what` replaced; fails the test when there is none.
inline std::string with(std::string text, const std::string& what, const std::string& replacement) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), replacement);
}

}  // namespace lf::mesh::test
