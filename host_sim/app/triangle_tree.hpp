// Distances from the surface of a mesh, whatever its size: a tree of boxes about its triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/geometry/pose.hpp"

namespace lf::app {

// To the plane where the point lies over the triangle, else to its nearest side.
double triangle_distance_m(const Vec3& point_m, const Vec3& a, const Vec3& b, const Vec3& c);

class TriangleTree {
 public:
  // Keeps references to both. O(n log n).
  TriangleTree(std::span<const Vec3> vertices_m, std::span<const std::array<std::uint32_t, 3>> triangles);

  // Distance of the nearest triangle, or `most_m` where none is nearer. O(log n) near the surface.
  double nearest_m(const Vec3& point_m, double most_m) const;

 private:
  struct Node {
    Vec3 least_m = Vec3::Zero(), most_m = Vec3::Zero();
    std::uint32_t begin = 0, end = 0;  // of `order_`
    std::uint32_t children = 0;        // the first of two that follow each other; 0: a leaf
  };
  void split(std::size_t node);
  double box_distance_m(const Node& node, const Vec3& point_m) const;

  std::span<const Vec3> vertices_m_;
  std::span<const std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::uint32_t> order_;  // of triangles, so that each node's are together
  std::vector<Node> nodes_;
};

}  // namespace lf::app
