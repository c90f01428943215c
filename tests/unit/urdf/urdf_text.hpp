// Small URDF files of a test's making.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "shared/input_error.hpp"
#include "shared/urdf/read_urdf.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::urdf::test {

// One joint between two links. The joint begins in line 4, its limit is in line 9.
inline const std::string elbow = R"(<robot name="r">
  <link name="base"/>
  <link name="arm"/>
  <joint name="elbow" type="revolute">
    <parent link="base"/>
    <child link="arm"/>
    <origin xyz="1 2 3" rpy="0 0 0"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" effort="3" velocity="4"/>
  </joint>
</robot>
)";

// A box with a mass. The inertial begins in line 3, its mass is in line 5, its inertia in line 6; visual 8, collision 11.
inline const std::string body = R"(<robot name="r">
  <link name="base">
    <inertial>
      <origin xyz="0 0 0.5"/>
      <mass value="2"/>
      <inertia ixx="2" ixy="0" ixz="0" iyy="3" iyz="0" izz="4"/>
    </inertial>
    <visual>
      <geometry><box size="1 2 3"/></geometry>
    </visual>
    <collision>
      <geometry><cylinder radius="1" length="2"/></geometry>
    </collision>
  </link>
</robot>
)";

// `text` with the first `what` replaced; fails the test when there is none.
inline std::string with(std::string text, const std::string& what, const std::string& replacement) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), replacement);
}

// The same, with a further element or two at the robot's end.
inline std::string and_also(const std::string& text, const std::string& elements) { return with(text, "</robot>", elements + "</robot>"); }

// A file arm.urdf in a folder of its own.
class Urdf {
 public:
  explicit Urdf(const std::string& text) { folder_.write("arm.urdf", text); }
  const lf::test::TemporaryFolder& folder() const { return folder_; }
  std::string path() const { return folder_ / "arm.urdf"; }

  Reading read(const ReadOptions& options = {}) const { return read_urdf(path(), options); }
  // "arm.urdf:4: ..."; "" when the file is read.
  std::string error(const ReadOptions& options = {}) const {
    try {
      (void)read(options);
    } catch (const InputError& refused) {
      return relative(refused.what());
    }
    return "";
  }
  // "arm.urdf:4: ..." each.
  std::vector<std::string> notes(const ReadOptions& options = {}) const {
    const Reading reading = read(options);
    std::vector<std::string> result;
    for (const Note& note : reading.notes) result.push_back(relative(reading.told(note)));
    return result;
  }

 private:
  // Without the folder's path.
  std::string relative(std::string text) const {
    const std::string prefix = folder_.path().string() + "/";
    for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix)) text.erase(at, prefix.size());
    return text;
  }

  lf::test::TemporaryFolder folder_;
};

inline std::string error_of(const std::string& text) { return Urdf(text).error(); }
// But for what the two base texts leave without mass.
inline std::vector<std::string> notes_of(const std::string& text) {
  std::vector<std::string> notes = Urdf(text).notes();
  std::erase_if(notes, [](const std::string& note) { return note.ends_with("has no inertial: it has no mass"); });
  return notes;
}
inline Mechanism read_text(const std::string& text) { return Urdf(text).read().mechanism; }

}  // namespace lf::urdf::test
