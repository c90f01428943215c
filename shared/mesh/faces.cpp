#include "shared/mesh/faces.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "shared/input_error.hpp"
#include "shared/mesh/read_mesh.hpp"
#include "shared/mesh/text.hpp"

namespace lf::mesh {
namespace {

constexpr const char* triangulate_it = ": triangulate it when exporting, or in a mesh editor";

// A fan of more than three corners.
class Fan {
 public:
  Fan(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices) : corners_(corners), vertices_(vertices) {
    Vec3 least = at(0), most = at(0);
    for (std::size_t i = 1; i < size(); ++i) {
      least = least.cwiseMin(at(i));
      most = most.cwiseMax(at(i));
    }
    extent_ = (most - least).maxCoeff();
    // Text of six digits is off by 1e-6 of the coordinate, and of the face.
    rounding_ = 1e-6 * extent_ + 2e-6 * std::max(least.cwiseAbs().maxCoeff(), most.cwiseAbs().maxCoeff());
    // Newell's normal: of any polygon, its length twice the area.
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 1; i + 1 < size(); ++i) normal += (at(i) - at(0)).cross(at(i + 1) - at(0));
    const double length = normal.norm();
    is_flat_ = length > 0;
    if (is_flat_) normal_ = normal / length;
  }

  // What keeps the face from being a fan; "" when nothing does.
  std::string fault() {
    if (!is_flat_) return "has no area";
    // A ten-thousandth of the face is what a modeller's own planes are off by.
    for (std::size_t i = 0; i < size(); ++i)
      if (std::abs(normal_.dot(at(i) - at(0))) > 1e-4 * extent_ + rounding_) return "is not planar";
    double turned_rad = 0;
    heights_.resize(size());
    for (std::size_t i = 0; i < size(); ++i) {
      const Vec3 before = at(i) - at(i + size() - 1), after = at(i + 1) - at(i);
      const double sine = normal_.dot(before.cross(after)), cosine = before.dot(after), chord = (before + after).norm();
      heights_[i] = chord > 0 ? sine / chord : 0;
      if (heights_[i] < -rounding_ || (heights_[i] <= rounding_ && cosine <= 0)) return "is not convex";
      turned_rad += std::atan2(sine, cosine);
    }
    // A star turns to the left at each corner, too, but twice around.
    if (turned_rad > 3 * pi) return "crosses itself";
    return "";
  }

  // Where the fan begins: a triangle of it would have no area where a neighbour of that corner lies on a straight line. Nothing when there is no such corner.
  std::optional<std::size_t> apex() const {
    // Of a circle of a thousand corners each is within the rounding.
    for (const double least_height : {rounding_, 1e-7 * extent_})
      for (std::size_t i = 0; i < size(); ++i)
        if (std::min(heights_[(i + 1) % size()], heights_[(i + size() - 1) % size()]) > least_height) return i;
    return std::nullopt;
  }

 private:
  std::size_t size() const { return corners_.size(); }
  const Vec3& at(std::size_t i) const { return vertices_[corners_[i % size()]]; }

  std::span<const std::uint32_t> corners_;
  const std::vector<Vec3>& vertices_;
  double extent_ = 0, rounding_ = 0;
  bool is_flat_ = false;
  Vec3 normal_ = Vec3::Zero();
  std::vector<double> heights_;  // of each corner over the line between its neighbours
};

}  // namespace

void refuse_too_many_triangles(std::uint64_t count, const std::string& file, int line) {
  if (count <= most_triangles) return;
  throw InputError(file, line,
                   "has " + std::to_string(count) + " triangles or more; " + std::to_string(most_triangles) +
                       " are read: decimate it in a mesh editor, or split it");
}

void refuse_too_many_vertices(std::uint64_t count, const std::string& file, int line) {
  if (count <= most_vertices) return;
  throw InputError(file, line,
                   "has " + std::to_string(count) + " vertices or more; " + std::to_string(most_vertices) +
                       " are read: decimate it in a mesh editor, or split it");
}

void refuse_too_many_corners(std::size_t count, const std::string& file, int line) {
  if (count > 2) refuse_too_many_triangles(count - 2, file, line);
}

void Faces::add(std::span<const std::uint32_t> corners, int line) {
  const std::size_t number = faces_.size() + 1;
  if (corners.size() < 3)
    throw InputError(file_, line,
                     "face " + std::to_string(number) + " has " + counted(corners.size(), "corner") +
                         ": it needs three; remove it, or export the file anew");
  // A face of n corners makes n - 2 triangles.
  refuse_too_many_triangles(corners_.size() + corners.size() - 2 * number, file_, line);
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  faces_.push_back({static_cast<std::uint32_t>(corners_.size()), line});
}

std::vector<Triangle> Faces::triangles(const std::vector<Vec3>& vertices) const {
  std::vector<Triangle> result;
  result.reserve(corners_.size() - 2 * faces_.size());
  std::size_t begin = 0;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const std::span<const std::uint32_t> corners(corners_.data() + begin, faces_[i].end - begin);
    begin = faces_[i].end;
    const auto refuse = [&](const std::string& text) {
      throw InputError(file_, faces_[i].line, "face " + std::to_string(i + 1) + " " + text);
    };
    for (const std::uint32_t corner : corners)
      if (corner >= vertices.size())
        refuse("has vertex " + std::to_string(std::uint64_t{corner} + first_index_) + ", but the file has " +
               counted(vertices.size(), "vertex") + ", counted from " + std::to_string(first_index_) + ": export it anew");
    if (corners.size() == 3) {
      result.push_back({corners[0], corners[1], corners[2]});
      continue;
    }
    Fan fan(corners, vertices);
    const std::string so_many = std::to_string(corners.size()) + " corners";
    if (const std::string fault = fan.fault(); !fault.empty()) refuse("of " + so_many + " " + fault + triangulate_it);
    const std::optional<std::size_t> apex = fan.apex();
    if (!apex) refuse("of " + so_many + " has its corners on straight lines, so that triangles would have no area" + triangulate_it);
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      result.push_back({corners[*apex], corners[(*apex + k) % corners.size()], corners[(*apex + k + 1) % corners.size()]});
  }
  return result;
}

}  // namespace lf::mesh
