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

std::vector<Vec3> finite_points(const std::vector<CloudPoint>& cloud) {
  std::vector<Vec3> points;
  for (const CloudPoint& point : cloud) {
    if (point.p_m.allFinite()) points.push_back(point.p_m.cast<double>());
  }
  return points;
}

// x right and y up as the robot sees the panel, z toward the robot; origin on the plane, under the points' middle.
Pose plane_from_base(const std::vector<Vec3>& points, const PlaneFit& fit) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : points) middle += p;
  middle /= static_cast<double>(points.size());
  const Plane plane = fit.valid ? fit.plane : Plane{-Vec3::UnitX(), middle.x()};  // without a fit: as the panel stands when docked exactly
  const Vec3 z = plane.normal.normalized();
  const Vec3 x = (Vec3::UnitY() - z * z.y()).normalized();
  Mat3 turn;
  turn << x.transpose(), z.cross(x).transpose(), z.transpose();
  Pose pose = Pose::Identity();
  pose.linear() = turn;
  pose.translation() = -(turn * (middle - z * plane.signed_distance_m(middle)));
  return pose;
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

// The cloud as the page shows it before its script does.
RgbImage drawn(const std::vector<Vec3>& points, const StageView& view) {
  constexpr std::int32_t width = 1120, height = 672;
  RgbImage image(width, height, ground);
  std::vector<float> depth(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), std::numeric_limits<float>::lowest());
  const double cy = std::cos(view.yaw_rad), sy = std::sin(view.yaw_rad), cp = std::cos(view.pitch_rad), sp = std::sin(view.pitch_rad);
  const double scale = 0.5 * std::min<double>(width, 1.35 * height) / view.radius_m;  // the panel fits
  for (const Vec3& p : points) {
    const double x = cy * p.x() + sy * p.z(), z = cy * p.z() - sy * p.x();
    const double y = cp * p.y() - sp * z, near = sp * p.y() + cp * z;
    const auto u = static_cast<std::int32_t>(std::lround(width / 2.0 + scale * x));
    const auto v = static_cast<std::int32_t>(std::lround(height / 2.0 - scale * y));
    for (std::int32_t k = 0; k < 4; ++k) {  // two by two pixels a point
      const std::int32_t pu = u + k % 2, pv = v + k / 2;
      if (pu < 0 || pv < 0 || pu >= width || pv >= height) continue;
      float& in_front = depth[static_cast<std::size_t>(pv) * static_cast<std::size_t>(width) + static_cast<std::size_t>(pu)];
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

std::string tools(bool has_cloud, bool has_robot) {
  std::string html =
      "<div class=\"tools live\" hidden><button type=\"button\" data-view=\"0.5,0.35\">oblique</button>"
      "<button type=\"button\" data-view=\"0,0\">front</button><button type=\"button\" data-view=\"0,1.5708\">from above</button>"
      "<button type=\"button\" data-view=\"1.5708,0\">from the side</button>"
      "<button type=\"button\" data-zoom=\"1.3\" aria-label=\"enlarge\">+</button>"
      "<button type=\"button\" data-zoom=\"0.77\" aria-label=\"reduce\">−</button>";
  if (has_robot && has_cloud) html += "<button type=\"button\" data-show=\"cloud\">cloud</button>";
  if (has_robot) {
    html +=
        "<button type=\"button\" data-show=\"robot\">robot</button>"
        "<button type=\"button\" data-show=\"controls\">valve, buttons</button><button type=\"button\" data-show=\"panel\">panel</button>"
        "<button type=\"button\" data-show=\"vehicle\">vehicle</button>";
  }
  return html + "</div>";
}

std::string facts(const ReportData& data, std::size_t shown) {
  std::string html = std::to_string(shown) + " of " + std::to_string(data.cloud.size()) + " points shown";
  if (data.fit.valid) {
    html += "; plane fitted to " + std::to_string(data.fit.inliers) + " of " + std::to_string(data.fit.points) + " points, " +
            formatted("%.2f mm rms", data.fit.rms_m * 1000);
  } else {
    html += "; no plane was fitted, distances are to the nominal panel through the points' middle";
  }
  return html;
}

}  // namespace

StageView stage_view(const ReportData& data) {
  StageView view;
  const std::vector<Vec3> points = finite_points(data.cloud);
  if (points.empty()) {
    view.view_from_base = data.motion.base_from_panel.inverse();
    return view;
  }
  view.view_from_base = plane_from_base(points, data.fit);
  double radius = 0.05;
  for (const Vec3& p : points) radius = std::max(radius, (view.view_from_base * p).head<2>().norm());
  view.radius_m = std::min(radius, 1.0);
  return view;
}

std::string cloud_html(const ReportData& data) {
  std::vector<Vec3> points = finite_points(data.cloud);
  const bool has_robot = !data.motion.parts.empty() && !data.motion.t_s.empty();
  if (points.empty() && !has_robot) return "";
  const StageView view = stage_view(data);
  for (Vec3& p : points) p = view.view_from_base * p;
  points = thinned(points);
  std::string html = "<div class=\"cloud\" id=\"cloud\">";
  if (!points.empty()) {
    html += "<img alt=\"The cloud seen from the robot's upper left\" src=\"data:image/png;base64," +
            base64(encode_png(drawn(points, view))) + "\">";
  }
  html += "<canvas width=\"1120\" height=\"672\" tabindex=\"0\" role=\"img\" aria-label=\"" +
          std::string(has_robot ? "Cloud and robot" : "Cloud") + " in 3D; arrow keys turn it, plus and minus enlarge it\" hidden></canvas>";
  html += tools(!points.empty(), has_robot) + "</div>";
  if (!points.empty()) {
    html += "<script type=\"text/plain\" id=\"points\">" + packed(points) + "</script>" + scale_legend() + "<p class=\"facts\">" +
            facts(data, points.size()) + "<span class=\"live\" hidden>; drag to turn</span>.</p>";
  }
  if (has_robot) html += "<p class=\"facts live\" hidden>The robot as it truly stood: <span id=\"tool-place\"></span>.</p>";
  return html;
}

}  // namespace lf::record
