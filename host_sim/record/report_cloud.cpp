#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host_sim/record/png.hpp"
#include "host_sim/record/report_parts.hpp"

namespace lf::record {
namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr double most_points = 40'000;
constexpr double units_per_m = 20'000;  // int16 steps of 0.05 mm reach 1.6 m
constexpr double fine_mm = 6;           // the fine scale's half range; beyond it the coarse one begins
constexpr double coarse_mm = 120;       // a handle stands 106 mm proud
constexpr Colour ground{14, 20, 27};

Colour mix(const Colour& a, const Colour& b, double share) {
  Colour c;
  for (std::size_t i = 0; i < 3; ++i) c[i] = static_cast<std::uint8_t>(std::lround(a[i] + (b[i] - a[i]) * std::clamp(share, 0.0, 1.0)));
  return c;
}

// Blue behind the plane, grey on it, red before it; what stands proud from violet to yellow. The script has the same scale.
Colour colour_of(double distance_mm) {
  constexpr Colour behind{58, 134, 255}, on{150, 160, 168}, before{255, 92, 80}, proud{150, 70, 220}, far{255, 224, 70};
  if (distance_mm > fine_mm) return mix(proud, far, (distance_mm - fine_mm) / (coarse_mm - fine_mm));
  return distance_mm < 0 ? mix(on, behind, -distance_mm / fine_mm) : mix(on, before, distance_mm / fine_mm);
}

// Weyl's sequence: an even choice that no sweep's pattern can meet in step, as it would a stride.
bool chosen(std::size_t i, double share) {
  const double place = 0.6180339887498949 * static_cast<double>(i);
  return place - std::floor(place) < share;
}

// In the plane's frame: x right and y up as the robot sees the panel, z toward the robot; origin at the points' middle.
std::vector<Vec3> points_on_plane(const std::vector<CloudPoint>& cloud, const PlaneFit& fit) {
  std::vector<Vec3> points;
  Vec3 middle = Vec3::Zero();
  for (const CloudPoint& point : cloud) {
    if (!point.p_m.allFinite()) continue;
    points.push_back(point.p_m.cast<double>());
    middle += points.back();
  }
  if (points.empty()) return points;
  middle /= static_cast<double>(points.size());
  const Plane plane = fit.valid ? fit.plane : Plane{-Vec3::UnitX(), middle.x()};  // without a fit: as the panel stands when docked exactly
  const Vec3 z = plane.normal.normalized();
  const Vec3 x = (Vec3::UnitY() - z * z.y()).normalized();
  Mat3 plane_from_base;
  plane_from_base << x.transpose(), z.cross(x).transpose(), z.transpose();
  const Vec3 origin = middle - z * plane.signed_distance_m(middle);
  for (Vec3& p : points) p = plane_from_base * (p - origin);
  return points;
}

// What stands proud is kept before what lies on the plane.
std::vector<Vec3> thinned(const std::vector<Vec3>& points) {
  const auto proud = [](const Vec3& p) { return std::abs(p.z()) * 1000 > fine_mm; };
  const auto proud_count = static_cast<double>(std::count_if(points.begin(), points.end(), proud));
  const auto flat_count = static_cast<double>(points.size()) - proud_count;
  const double proud_share = std::min(1.0, 0.5 * most_points / std::max(1.0, proud_count));
  const double flat_share = std::min(1.0, (most_points - proud_share * proud_count) / std::max(1.0, flat_count));
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (chosen(i, proud(points[i]) ? proud_share : flat_share)) kept.push_back(points[i]);
  }
  return kept;
}

std::string packed(const std::vector<Vec3>& points) {
  std::vector<std::uint8_t> bytes;
  for (const Vec3& p : points) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto value = static_cast<std::int16_t>(std::clamp(std::lround(p[axis] * units_per_m), -32768L, 32767L));
      bytes.push_back(static_cast<std::uint8_t>(value & 0xFF));
      bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint16_t>(value) >> 8));
    }
  }
  return base64(bytes);
}

struct View {
  std::int32_t width = 1120, height = 620;
  double yaw_rad = 0.5, pitch_rad = 0.35;
};

// Metres to pixels, so that the panel fits.
double scale_of(const std::vector<Vec3>& points, const View& view) {
  double radius = 0.05;
  for (const Vec3& p : points) radius = std::max(radius, p.head<2>().norm());
  return 0.5 * std::min<double>(view.width, 1.35 * view.height) / std::min(radius, 1.0);
}

RgbImage drawn(const std::vector<Vec3>& points, const View& view) {
  RgbImage image(view.width, view.height, ground);
  std::vector<float> depth(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height),
                           std::numeric_limits<float>::lowest());
  const double cy = std::cos(view.yaw_rad), sy = std::sin(view.yaw_rad), cp = std::cos(view.pitch_rad), sp = std::sin(view.pitch_rad);
  const double scale = scale_of(points, view);
  for (const Vec3& p : points) {
    const double x = cy * p.x() + sy * p.z(), z = cy * p.z() - sy * p.x();
    const double y = cp * p.y() - sp * z, near = sp * p.y() + cp * z;
    const auto u = static_cast<std::int32_t>(std::lround(view.width / 2.0 + scale * x));
    const auto v = static_cast<std::int32_t>(std::lround(view.height / 2.0 - scale * y));
    for (std::int32_t k = 0; k < 4; ++k) {  // two by two pixels a point
      const std::int32_t pu = u + k % 2, pv = v + k / 2;
      if (pu < 0 || pv < 0 || pu >= view.width || pv >= view.height) continue;
      float& in_front = depth[static_cast<std::size_t>(pv) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(pu)];
      if (static_cast<float>(near) < in_front) continue;
      in_front = static_cast<float>(near);
      image.set(pu, pv, colour_of(p.z() * 1000));
    }
  }
  return image;
}

std::string css(const Colour& c) { return "rgb(" + std::to_string(c[0]) + "," + std::to_string(c[1]) + "," + std::to_string(c[2]) + ")"; }

std::string gradient(double from_mm, double to_mm) {
  std::string stops;
  for (int i = 0; i <= 8; ++i) stops += (i > 0 ? "," : "") + css(colour_of(from_mm + (to_mm - from_mm) * i / 8));
  return "<i style=\"background:linear-gradient(90deg," + stops + ")\"></i>";
}

std::string scale_legend() {
  return "<div class=\"scale\"><span>" + formatted("%.0f", -fine_mm) + "</span>" + gradient(-fine_mm, fine_mm) + "<span>" +
         formatted("+%.0f", fine_mm) + "</span>" + gradient(fine_mm + 0.01, coarse_mm) + "<span>" + formatted("+%.0f", coarse_mm) +
         "</span> mm from the fitted plane, positive toward the robot</div>";
}

}  // namespace

std::string cloud_view(const std::vector<CloudPoint>& cloud, const PlaneFit& fit) {
  const std::vector<Vec3> points = thinned(points_on_plane(cloud, fit));
  if (points.empty()) return "";
  const View view;
  const std::string picture = base64(encode_png(drawn(points, view)));
  std::string html = "<div class=\"cloud\" id=\"cloud\" data-scale=\"" + formatted("%.3f", scale_of(points, view) / units_per_m) + "\">";
  html += "<img alt=\"The cloud seen from the robot's upper left\" src=\"data:image/png;base64," + picture + "\">";
  html += "<canvas width=\"" + std::to_string(view.width) + "\" height=\"" + std::to_string(view.height) + "\" hidden></canvas>";
  html +=
      "<div class=\"tools\" hidden><button data-view=\"0.5,0.35\">oblique</button><button data-view=\"0,0\">front</button>"
      "<button data-view=\"0,1.5708\">from above</button><button data-view=\"1.5708,0\">from the side</button>"
      "<button data-zoom=\"1.3\">+</button><button data-zoom=\"0.77\">−</button></div></div>";
  html += "<script type=\"text/plain\" id=\"points\">" + packed(points) + "</script>" + scale_legend();
  std::string facts = std::to_string(points.size()) + " of " + std::to_string(cloud.size()) + " points shown";
  if (fit.valid) {
    facts += "; plane fitted to " + std::to_string(fit.inliers) + " of " + std::to_string(fit.points) + " points, " +
             formatted("%.2f mm rms", fit.rms_m * 1000);
  } else {
    facts += "; no plane was fitted, distances are to the nominal panel through the points' middle";
  }
  return html + "<p class=\"facts\">" + facts + "<span class=\"live\" hidden>; drag to turn</span>.</p>";
}

}  // namespace lf::record
