// Reads a URDF file strictly: what is in it is either used, or told, or refused. Hosted side only.
//
// Source: wiki.ros.org/urdf/XML, and what files of real arms hold. Where the specification leaves a choice, this reader does as urdfdom does and says so.
//
// Used:    robot, link, inertial, visual, collision, geometry {box, cylinder, sphere, mesh}, material, color, joint {origin, parent, child, axis, limit,
//          safety_controller's soft limits, dynamics, mimic}, and this project's own elements (<lanternfish:...>).
// Told:    what is valid and of no use here (transmission, gazebo, ros2_control, sensor, calibration, texture, elements and attributes with
//          another prefix), every default that was assumed, and every number that was changed or means "not known".
// Refused: everything else, and every number that cannot be. Numbers are read with a decimal point whatever the locale, and to their last character.
//
//   joint types     revolute, continuous, prismatic, fixed. A range of no width makes a joint fixed, where it stands.
//   axis            made a unit vector; told when it was none. 1 0 0 where the file has none.
//   origin          of several the first. Nothing is rounded to right angles: rpy is yaw after pitch after roll about fixed axes, R = Rz Ry Rx.
//   limits          the tighter of <limit> and a safety_controller's soft limits, told. A soft limit that is not given is none.
//   effort, speed   0 and 1000 stand for "not known" in many files: they become nothing.
//   inertial        mass 0 with inertia 0 is no inertial.
//   mesh            package://NAME/PATH and model://NAME/PATH are looked for in the given folders, then from the file's folder upward, then beside the file.
//                   Formats: STL, OBJ, PLY, COLLADA.
//
// Bounds: 16 MB, 100 elements deep, 4096 links; lengths 1000 m, angles 1000 rad.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/urdf/mechanism.hpp"

namespace lf::urdf {

// What was read and is not what the file says, or is of no use here.
struct Note {
  int line = 0;
  std::string text;
};

struct Reading {
  Mechanism mechanism;
  std::vector<Note> notes;  // in the order of their lines

  // "file:line: text".
  std::string told(const Note& note) const;
};

struct ReadOptions {
  std::vector<std::filesystem::path> package_folders;  // that hold folders of packages: FOLDER/NAME/PATH
  bool ignore_missing_meshes =
      false;  // a collision whose mesh is missing is left out, and told; otherwise it is refused. Visuals always are
};

// Throws InputError: one line "file:line: what is wrong, and the remedy" for each problem, in the order of their lines, at most 50. Of a file that is not
// well-formed XML, or whose macros are not expanded, the first problem alone. O(n log n) in the file's size.
Reading read_urdf(const std::string& file, const ReadOptions& options = {});

}  // namespace lf::urdf
