#include "hal/vision/corner_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace lf::vision {
namespace {

struct Line {
  Vec2 point, direction;
};

// Bilinear; the caller keeps the pixel inside the image.
double grey(ImageView image, const Vec2& p) {
  const auto u = static_cast<std::int32_t>(p.x());
  const auto v = static_cast<std::int32_t>(p.y());
  const double fu = p.x() - u, fv = p.y() - v;
  const double upper = image.at(u, v) * (1 - fu) + image.at(u + 1, v) * fu;
  const double lower = image.at(u, v + 1) * (1 - fu) + image.at(u + 1, v + 1) * fu;
  return upper * (1 - fv) + lower * fv;
}

bool inside(ImageView image, const Vec2& p) { return p.x() >= 0 && p.y() >= 0 && p.x() < image.width - 1 && p.y() < image.height - 1; }

// Where the edge crosses the profile from -reach to +reach along `normal`: the centroid of the gradient.
std::optional<double> crossing(ImageView image, const Vec2& at, const Vec2& normal, double reach_px) {
  constexpr int steps = 12;
  constexpr double min_contrast = 12;  // grey levels: 4 sigma of the noisiest camera
  if (!inside(image, at - reach_px * normal) || !inside(image, at + reach_px * normal)) return std::nullopt;
  const double first = grey(image, at - reach_px * normal);
  double previous = first, moment = 0;
  for (int i = 1; i <= steps; ++i) {
    const double value = grey(image, at + reach_px * (2.0 * i / steps - 1) * normal);
    moment += (value - previous) * reach_px * ((2.0 * i - 1) / steps - 1);
    previous = value;
  }
  const double contrast = previous - first;
  if (std::abs(contrast) < min_contrast) return std::nullopt;
  const double offset = moment / contrast;
  if (std::abs(offset) > reach_px) return std::nullopt;
  return offset;
}

Line fit_line(const std::vector<Vec2>& points) {
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  double xx = 0, xy = 0, yy = 0;
  for (const Vec2& p : points) {
    const Vec2 d = p - mean;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
  const double angle_rad = 0.5 * std::atan2(2 * xy, xx - yy);
  return {mean, Vec2(std::cos(angle_rad), std::sin(angle_rad))};
}

double distance(const Line& line, const Vec2& p) {
  const Vec2 d = p - line.point;
  return std::abs(line.direction.x() * d.y() - line.direction.y() * d.x());
}

// The line through the edge from a to b; none when less than half of its profiles cross it, or it is longer than the image's diagonal.
std::optional<Line> edge_line(ImageView image, const Vec2& a, const Vec2& b, int cells) {
  const double length_px = (b - a).norm();
  if (!(length_px >= 2 * cells && length_px <= std::hypot(image.width, image.height))) return std::nullopt;
  const Vec2 along = (b - a) / length_px;
  const Vec2 normal(-along.y(), along.x());
  const double reach_px = std::clamp(0.5 * length_px / cells, 1.5, 4.0);
  const int profiles = static_cast<int>(length_px);
  std::vector<Vec2> points;
  for (int i = 0; i < profiles; ++i) {
    const double share = 0.08 + 0.84 * (i + 0.5) / profiles;  // the ends see the neighbouring edges
    const Vec2 at = a + share * (b - a);
    if (const auto offset = crossing(image, at, normal, reach_px)) points.push_back(at + *offset * normal);
  }
  if (points.size() < static_cast<std::size_t>(std::max(4, profiles / 2))) return std::nullopt;
  Line line = fit_line(points);
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const Vec2& p : points) distances.push_back(distance(line, p));
  std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2), distances.end());
  const double limit_px = std::max(0.1, 3.7 * distances[distances.size() / 2]);  // 2.5 sigma
  std::erase_if(points, [&](const Vec2& p) { return distance(line, p) > limit_px; });
  if (points.size() >= 4) line = fit_line(points);
  return line;
}

std::optional<Vec2> intersection(const Line& a, const Line& b) {
  const double cross = a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x();
  if (std::abs(cross) < 0.1) return std::nullopt;
  const Vec2 d = b.point - a.point;
  return a.point + a.direction * ((d.x() * b.direction.y() - d.y() * b.direction.x()) / cross);
}

std::optional<std::array<Vec2, 4>> refine_once(ImageView image, const std::array<Vec2, 4>& corners, int cells) {
  std::array<Line, 4> lines;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto line = edge_line(image, corners[i], corners[(i + 1) % 4], cells);
    if (!line) return std::nullopt;
    lines[i] = *line;
  }
  std::array<Vec2, 4> refined;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto corner = intersection(lines[(i + 3) % 4], lines[i]);
    if (!corner) return std::nullopt;
    refined[i] = *corner;
  }
  return refined;
}

}  // namespace

std::array<Vec2, 4> refine_corners(ImageView image, const std::array<Vec2, 4>& corners_px, int cells) {
  constexpr double largest_move_px = 1.5;
  std::array<Vec2, 4> refined = corners_px;
  for (int round = 0; round < 2; ++round) {  // the second sees its profiles centred
    const auto next = refine_once(image, refined, cells);
    if (!next) return corners_px;
    refined = *next;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if (!((refined[i] - corners_px[i]).norm() <= largest_move_px)) return corners_px;
  }
  return refined;
}

}  // namespace lf::vision
