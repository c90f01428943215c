#include "shared/mesh/shells.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace lf::mesh {
namespace {

// Disjoint sets with path halving (Tarjan, van Leeuwen 1984).
class Sets {
 public:
  explicit Sets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0U); }

  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // Under the lower root.
  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t root_a = root(a), root_b = root(b);
    parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

std::vector<Side> sides_of(const Mesh& mesh, const std::vector<bool>& left_out) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (left_out[i]) continue;
    const Triangle& triangle = mesh.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangle[k], to = triangle[(k + 1) % 3];
      if (from != to) sides.push_back({std::min(from, to), std::max(from, to), i, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle); });
  return sides;
}

std::vector<Shell> shells_of(const Mesh& mesh, const std::vector<bool>& left_out) {
  Sets sets(mesh.vertices_m.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (left_out[i]) continue;
    sets.join(mesh.triangles[i][0], mesh.triangles[i][1]);
    sets.join(mesh.triangles[i][0], mesh.triangles[i][2]);
  }
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> shell_of_root(mesh.vertices_m.size(), none);
  std::vector<Shell> shells;
  std::vector<Vec3> origins;  // on the shell: far from it the sum would lose its digits
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (left_out[i]) continue;
    const Triangle& triangle = mesh.triangles[i];
    std::uint32_t& index = shell_of_root[sets.root(triangle[0])];
    const Vec3& corner = mesh.vertices_m[triangle[0]];
    if (index == none) {
      index = static_cast<std::uint32_t>(shells.size());
      shells.push_back({i, 0, corner, corner});
      origins.push_back(corner);
    }
    Shell& shell = shells[index];
    shell.volume_m3 += six_volumes(mesh, triangle, origins[index]) / 6;
    for (const std::uint32_t vertex : triangle) {
      shell.least_m = shell.least_m.cwiseMin(mesh.vertices_m[vertex]);
      shell.most_m = shell.most_m.cwiseMax(mesh.vertices_m[vertex]);
    }
  }
  return shells;
}

double six_volumes(const Mesh& mesh, const Triangle& triangle, const Vec3& origin) {
  const auto corner = [&](std::size_t k) -> Vec3 { return mesh.vertices_m[triangle[k]] - origin; };
  return corner(0).dot(corner(1).cross(corner(2)));
}

}  // namespace lf::mesh
