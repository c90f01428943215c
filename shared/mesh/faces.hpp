// The faces of a file, and triangles made of them. Inside this folder only.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "shared/mesh/mesh.hpp"

namespace lf::mesh {

// Throws InputError when there are more than read_mesh reads. `line` 0 leaves the line out.
void refuse_too_many_triangles(std::uint64_t count, const std::string& file, int line);
void refuse_too_many_vertices(std::uint64_t count, const std::string& file, int line);

// The same while the corners of one face are read: their count may be anything.
void refuse_too_many_corners(std::size_t count, const std::string& file, int line);

class Faces {
 public:
  // `first_index`: what the file's format counts vertices from. It is taken off the corners already; messages have it.
  Faces(std::string file, std::uint32_t first_index) : file_(std::move(file)), first_index_(first_index) {}

  // Throws InputError for less than three corners, and for too many triangles.
  void add(std::span<const std::uint32_t> corners, int line);
  std::size_t size() const { return faces_.size(); }

  // Every face as triangles with its own sense of turning, in the file's order. A face of more than three corners becomes a fan, so it has to be planar and
  // convex: of any other the triangles are a matter of choice, and programs choose differently. Throws InputError. O(corners).
  std::vector<Triangle> triangles(const std::vector<Vec3>& vertices) const;

 private:
  struct Face {
    std::uint32_t end;  // of its corners
    int line;
  };
  std::string file_;
  std::uint32_t first_index_;
  std::vector<std::uint32_t> corners_;
  std::vector<Face> faces_;
};

}  // namespace lf::mesh
