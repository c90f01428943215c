#include "shared/mesh/judge.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "shared/input_error.hpp"
#include "shared/mesh/shells.hpp"
#include "shared/mesh/text.hpp"

namespace lf::mesh {
namespace {

constexpr std::size_t most_nested = 2000;  // four million comparisons of boxes

class Judge {
 public:
  explicit Judge(const Mesh& mesh) : mesh_(mesh), left_out_(mesh.triangles.size(), false) {}

  MeshFaults judge() {
    find_unused();
    find_degenerate();
    find_duplicates();
    find_edges();
    const bool are_edges_right = faults_.open_edges.count + faults_.crowded_edges.count + faults_.inconsistent_edges.count == 0;
    if (are_edges_right) find_inside_out();
    return faults_;
  }

 private:
  const Vec3& at(std::uint32_t vertex) const { return mesh_.vertices_m[vertex]; }
  template <class Place>
  static void add(Found<Place>& found, const Place& place) {
    if (found.count++ == 0) found.first = place;
  }
  TrianglePlace place_of(std::size_t triangle) const {
    const Triangle& corners = mesh_.triangles[triangle];
    return {triangle, {at(corners[0]), at(corners[1]), at(corners[2])}};
  }
  EdgePlace place_of(const Side& side, const Side& other) const {
    const std::uint32_t from = side.rises ? side.low : side.high, to = side.rises ? side.high : side.low;
    return {{from, to}, {at(from), at(to)}, {side.triangle, other.triangle}};
  }

  void find_unused() {
    std::vector<bool> is_used(mesh_.vertices_m.size(), false);
    for (const Triangle& triangle : mesh_.triangles)
      for (const std::uint32_t corner : triangle) is_used[corner] = true;
    for (std::uint32_t i = 0; i < is_used.size(); ++i)
      if (!is_used[i]) add(faults_.unused_vertices, {i, at(i)});
  }

  void find_degenerate() {
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      const Triangle& t = mesh_.triangles[i];
      left_out_[i] = t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
      const Vec3 a = at(t[1]) - at(t[0]), b = at(t[2]) - at(t[0]);
      const double longest2 = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
      if (left_out_[i] || a.cross(b).norm() <= std::numeric_limits<float>::epsilon() * longest2) add(faults_.degenerate, place_of(i));
    }
  }

  void find_duplicates() {
    const auto key = [&](std::size_t i) {
      Triangle sorted = mesh_.triangles[i];
      std::sort(sorted.begin(), sorted.end());
      return sorted;
    };
    std::vector<std::uint32_t> order(mesh_.triangles.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const Triangle key_a = key(a), key_b = key(b);
      return key_a != key_b ? key_a < key_b : a < b;
    });
    std::vector<bool> is_duplicate(order.size(), false);
    for (std::size_t i = 1; i < order.size(); ++i) is_duplicate[order[i]] = !left_out_[order[i]] && key(order[i]) == key(order[i - 1]);
    for (std::size_t i = 0; i < is_duplicate.size(); ++i) {
      if (!is_duplicate[i]) continue;
      add(faults_.duplicates, place_of(i));
      left_out_[i] = true;
    }
  }

  void find_edges() {
    const std::vector<Side> sides = sides_of(mesh_, left_out_);
    std::vector<Side> open;
    for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
      while (end < sides.size() && sides[end].low == sides[begin].low && sides[end].high == sides[begin].high) ++end;
      const Side &first = sides[begin], &last = sides[end - 1];
      if (end - begin == 1) {
        add(faults_.open_edges, place_of(first, first));
        open.push_back(first);
      } else if (end - begin > 2) {
        add(faults_.crowded_edges, place_of(first, last));
      } else if (first.rises == last.rises) {
        add(faults_.inconsistent_edges, place_of(first, last));
      }
    }
    faults_.open_edges_that_meet = count_meeting(open);
  }

  std::size_t count_meeting(const std::vector<Side>& open) const {
    using Ends = std::array<double, 6>;
    std::vector<Ends> edges;
    edges.reserve(open.size());
    for (const Side& side : open) {
      std::array<double, 3> a{at(side.low).x(), at(side.low).y(), at(side.low).z()},
          b{at(side.high).x(), at(side.high).y(), at(side.high).z()};
      if (b < a) std::swap(a, b);
      edges.push_back({a[0], a[1], a[2], b[0], b[1], b[2]});
    }
    std::sort(edges.begin(), edges.end());
    std::size_t count = 0;
    for (std::size_t i = 0; i < edges.size(); ++i)
      if ((i > 0 && edges[i] == edges[i - 1]) || (i + 1 < edges.size() && edges[i] == edges[i + 1])) ++count;
    return count;
  }

  void find_inside_out() {
    const std::vector<Shell> shells = shells_of(mesh_, left_out_);
    double sum_m3 = 0;
    for (const Shell& shell : shells) sum_m3 += shell.volume_m3;
    for (const Shell& shell : shells) {
      const double side_m = (shell.most_m - shell.least_m).maxCoeff();
      // A billionth of a cube of its size is rounding.
      if (shell.volume_m3 > 1e-12 * side_m * side_m * side_m) continue;
      const bool is_cavity = shell.volume_m3 < 0 && sum_m3 > 0 && (shells.size() > most_nested || is_nested(shell, shells));
      if (!is_cavity) add(faults_.inside_out_shells, place_of(shell.first_triangle));
    }
  }
  static bool is_nested(const Shell& shell, const std::vector<Shell>& shells) {
    return std::any_of(shells.begin(), shells.end(), [&](const Shell& other) {
      return other.volume_m3 > -shell.volume_m3 && (other.least_m.array() <= shell.least_m.array()).all() &&
             (other.most_m.array() >= shell.most_m.array()).all();
    });
  }

  const Mesh& mesh_;
  std::vector<bool> left_out_;
  MeshFaults faults_;
};

std::string placed(const TrianglePlace& place) {
  return "triangle " + std::to_string(place.triangle + 1) + " with the corners " + shown(place.corners_m[0]) + ", " +
         shown(place.corners_m[1]) + ", " + shown(place.corners_m[2]);
}
std::string placed(const EdgePlace& place) { return "from " + shown(place.ends_m[0]) + " to " + shown(place.ends_m[1]); }
std::string and_first(std::size_t count) { return count > 1 ? ", the first " : ", "; }
std::string are(std::size_t count, std::string_view noun) { return counted(count, noun) + (count == 1 ? " is " : " are "); }
std::string between(const EdgePlace& place) {
  return " of triangles " + std::to_string(place.triangles[0] + 1) + " and " + std::to_string(place.triangles[1] + 1);
}

}  // namespace

MeshMeasures measure(const Mesh& mesh) {
  MeshMeasures result;
  if (mesh.vertices_m.empty()) return result;
  result.least_m = result.most_m = mesh.vertices_m.front();
  for (const Vec3& vertex : mesh.vertices_m) {
    result.least_m = result.least_m.cwiseMin(vertex);
    result.most_m = result.most_m.cwiseMax(vertex);
  }
  const Vec3 middle = (result.least_m + result.most_m) / 2;
  Vec3 moment = Vec3::Zero();
  double six_volumes_m3 = 0;
  std::vector<bool> is_used(mesh.vertices_m.size(), false);
  for (const Triangle& triangle : mesh.triangles) {
    const Vec3 a = mesh.vertices_m[triangle[0]] - middle, b = mesh.vertices_m[triangle[1]] - middle,
               c = mesh.vertices_m[triangle[2]] - middle;
    const double part = six_volumes(mesh, triangle, middle);
    six_volumes_m3 += part;
    moment += part * (a + b + c) / 4;
    result.area_m2 += (b - a).cross(c - a).norm() / 2;
    for (const std::uint32_t corner : triangle) is_used[corner] = true;
  }
  result.volume_m3 = six_volumes_m3 / 6;
  result.centroid_m = middle;
  if (six_volumes_m3 != 0) result.centroid_m += moment / six_volumes_m3;
  const std::vector<bool> none_left_out(mesh.triangles.size(), false);
  const std::vector<Side> sides = sides_of(mesh, none_left_out);
  for (std::size_t i = 0; i < sides.size(); ++i)
    if (i == 0 || sides[i].low != sides[i - 1].low || sides[i].high != sides[i - 1].high) ++result.edges;
  result.shells = shells_of(mesh, none_left_out).size();
  result.euler = std::count(is_used.begin(), is_used.end(), true) - static_cast<std::ptrdiff_t>(result.edges) +
                 static_cast<std::ptrdiff_t>(mesh.triangles.size());
  return result;
}

MeshFaults judge(const Mesh& mesh) { return Judge(mesh).judge(); }

bool MeshFaults::any() const {
  return open_edges.count + crowded_edges.count + inconsistent_edges.count + inside_out_shells.count + degenerate.count + duplicates.count +
             unused_vertices.count >
         0;
}

std::vector<std::string> sentences(const MeshFaults& faults) {
  std::vector<std::string> result;
  if (const auto& f = faults.open_edges; f.count > 0)
    result.push_back(are(f.count, "edge") + "open" + and_first(f.count) + placed(f.first) + " of triangle " +
                     std::to_string(f.first.triangles[0] + 1) +
                     (faults.open_edges_that_meet == 0 ? ": fill the holes in a mesh editor"
                                                       : "; " + std::to_string(faults.open_edges_that_meet) +
                                                             " of them lie upon each other: merge vertices by distance in a mesh editor" +
                                                             (faults.open_edges_that_meet == f.count ? "" : ", and fill the holes")));
  if (const auto& f = faults.crowded_edges; f.count > 0)
    result.push_back(are(f.count, "edge") + "shared by more than two triangles" + and_first(f.count) + placed(f.first) + between(f.first) +
                     " among others: remove inner faces, or part bodies that touch, in a mesh editor");
  if (const auto& f = faults.inconsistent_edges; f.count > 0)
    result.push_back(are(f.count, "edge") + "between triangles that turn in opposite senses" + and_first(f.count) + placed(f.first) +
                     between(f.first) + ": recalculate the normals in a mesh editor");
  if (const auto& f = faults.inside_out_shells; f.count > 0)
    result.push_back(are(f.count, "closed surface") + "inside out, or without volume" + and_first(f.count) + "with " + placed(f.first) +
                     ": flip the normals in a mesh editor");
  if (const auto& f = faults.degenerate; f.count > 0)
    result.push_back(are(f.count, "triangle") + "without area" + and_first(f.count) + placed(f.first) +
                     ": dissolve degenerate faces in a mesh editor");
  if (const auto& f = faults.duplicates; f.count > 0)
    result.push_back(counted(f.count, "triangle") + (f.count == 1 ? " repeats" : " repeat") + " an earlier one" + and_first(f.count) +
                     placed(f.first) + ": remove double faces in a mesh editor");
  if (const auto& f = faults.unused_vertices; f.count > 0)
    result.push_back(are(f.count, "vertex") + "in no triangle" + and_first(f.count) + "at " + shown(f.first.at_m) +
                     ": remove loose vertices in a mesh editor");
  return result;
}

void require_solid(const Mesh& mesh, const std::string& name) {
  if (mesh.triangles.empty()) throw InputError(name, 0, "has no triangles: export the mesh anew");
  std::string message;
  for (const std::string& sentence : sentences(judge(mesh)))
    message.append(message.empty() ? "" : "\n").append(name).append(": ").append(sentence);
  if (!message.empty()) throw InputError(message);
}

}  // namespace lf::mesh
