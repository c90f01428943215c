// Reads a triangle mesh from OBJ, STL (text, binary) or PLY (text, binary of both byte orders), strictly: what is in the file is used, or told, or refused.
// Hosted side only.
//
// Sources: Wavefront Advanced Visualizer, appendix B1 (OBJ); 3D Systems, StereoLithography Interface Specification (STL); G. Turk, The PLY Polygon File Format.
//
// Used:    vertices and faces. A face of more than three corners becomes a fan of triangles when it is planar and convex.
// Told:    the unit and the axes, which no such file states; groups that were merged; what is of no use here (normals, texture coordinates, colours, materials,
//          further properties and elements); STL's normals where the order of the corners says otherwise; a last line without its end.
// Refused: everything else: numbers that are none, indices that are out of range, counts that the file does not keep, faces of two corners, free-form surfaces,
//          and a file whose name says another format than its first bytes.
//
//   vertices   STL has none of its own: corners at exactly the same place become one vertex. OBJ and PLY keep theirs; `merge_vertices` does the same to them.
//   winding    as the file has it: counter-clockwise from outside. A scale that mirrors turns it, so that outside stays outside.
//   cut off    Told by the file's own count or end, where it has one. OBJ has neither: one that is cut between two lines is a shorter OBJ, whose surface is open.
//              `require_solid` (judge.hpp) finds that.
//
// Bounds: the longest side from 1 mm to 100 m, coordinates within 1000 m.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "shared/mesh/mesh.hpp"

namespace lf::mesh {

// A triangle with three vertices of its own takes 84 bytes, so this many take 168 MB. Models of valves and panels have 1e3 to 1e5.
inline constexpr std::size_t most_triangles = 2'000'000;
inline constexpr std::size_t most_vertices = 3 * most_triangles;
// Of a file, which is held in memory while it is read: text of that many triangles has 80 (OBJ) to 520 MB (STL).
inline constexpr std::size_t most_bytes = std::size_t{512} << 20;
inline constexpr double least_side_m = 1e-3, most_side_m = 100, most_coordinate_m = 1000;

struct Note {
  int line = 0;  // 0: of the whole file
  std::string text;
};

struct Reading {
  std::string file;
  Mesh mesh;
  std::vector<Note> notes;  // what was assumed, changed or not used

  void note(int line, const std::string& text);
  // "file:line: text".
  std::string told(const Note& note) const;
};

// Metres are the file's numbers times `scale`. Throws InputError, "file:line: what is wrong, and the remedy": the first problem alone, since a program wrote the
// others in the same way. Takes memory in proportion to the file's size, never to a count that the file states. O(n log n).
Reading read_mesh(const std::string& file, const Vec3& scale = Vec3::Ones());

// The same of a file's bytes; `file` is its name, with the extension.
Reading parse_mesh(const std::string& file, std::string_view bytes, const Vec3& scale = Vec3::Ones());

}  // namespace lf::mesh
