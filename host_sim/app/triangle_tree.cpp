#include "host_sim/app/triangle_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace lf::app {
namespace {

constexpr std::uint32_t leaf_triangles = 4;  // the tree of 2,000,000 triangles then takes 67 MB, and not four times as much

double segment_distance_m(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double t = along.squaredNorm() > 0 ? std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

}  // namespace

double triangle_distance_m(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const auto inside_of = [&](const Vec3& from, const Vec3& to) { return normal.dot((to - from).cross(p - from)) >= 0; };
  if (normal.squaredNorm() > 0 && inside_of(a, b) && inside_of(b, c) && inside_of(c, a)) return std::abs(normal.normalized().dot(p - a));
  return std::min({segment_distance_m(p, a, b), segment_distance_m(p, b, c), segment_distance_m(p, c, a)});
}

TriangleTree::TriangleTree(std::span<const Vec3> vertices_m, std::span<const std::array<std::uint32_t, 3>> triangles)
    : vertices_m_(vertices_m), triangles_(triangles), order_(triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  if (triangles.empty()) return;
  nodes_.push_back({Vec3::Zero(), Vec3::Zero(), 0, static_cast<std::uint32_t>(triangles.size()), 0});
  for (std::size_t node = 0; node < nodes_.size(); ++node) split(node);  // grows while it runs
}

// At the middle one of its triangles along the box's longest side.
void TriangleTree::split(std::size_t index) {
  Node node = nodes_[index];
  node.least_m = Vec3::Constant(std::numeric_limits<double>::infinity());
  node.most_m = -node.least_m;
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    for (const std::uint32_t corner : triangles_[order_[i]]) {
      node.least_m = node.least_m.cwiseMin(vertices_m_[corner]);
      node.most_m = node.most_m.cwiseMax(vertices_m_[corner]);
    }
  }
  if (node.end - node.begin > leaf_triangles) {
    Vec3::Index axis = 0;
    (node.most_m - node.least_m).maxCoeff(&axis);
    const auto place = [&](std::uint32_t triangle) {
      const auto& corners = triangles_[triangle];
      return vertices_m_[corners[0]][axis] + vertices_m_[corners[1]][axis] + vertices_m_[corners[2]][axis];
    };
    const std::uint32_t middle = node.begin + (node.end - node.begin) / 2;
    std::nth_element(order_.begin() + node.begin, order_.begin() + middle, order_.begin() + node.end,
                     [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
    node.children = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({Vec3::Zero(), Vec3::Zero(), node.begin, middle, 0});
    nodes_.push_back({Vec3::Zero(), Vec3::Zero(), middle, node.end, 0});
  }
  nodes_[index] = node;
}

double TriangleTree::box_distance_m(const Node& node, const Vec3& p) const {
  return (node.least_m - p).cwiseMax(p - node.most_m).cwiseMax(0.0).norm();
}

double TriangleTree::nearest_m(const Vec3& p, double most_m) const {
  if (nodes_.empty()) return most_m;
  double nearest = most_m;
  std::array<std::uint32_t, 64> waiting{};  // a level has one node waiting: enough for 2^63 triangles
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const Node& node = nodes_[waiting[--count]];
    if (box_distance_m(node, p) >= nearest) continue;
    if (node.children == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        const auto& t = triangles_[order_[i]];
        nearest = std::min(nearest, triangle_distance_m(p, vertices_m_[t[0]], vertices_m_[t[1]], vertices_m_[t[2]]));
      }
      continue;
    }
    // The nearer child is looked at first.
    const std::uint32_t first = node.children, second = first + 1;
    const bool swapped = box_distance_m(nodes_[second], p) < box_distance_m(nodes_[first], p);
    waiting[count++] = swapped ? first : second;
    waiting[count++] = swapped ? second : first;
  }
  return nearest;
}

}  // namespace lf::app
