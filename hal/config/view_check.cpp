#include "hal/config/view_check.hpp"

#include <array>
#include <cstdio>
#include <optional>

#include "firmware/scan/camera_model.hpp"
#include "hal/config/task_reach.hpp"

namespace lf::config {

namespace {

std::string lens_keys(const Machine& machine) {
  return machine.camera_calibration.empty() ? "'camera.focal_px', 'camera.distortion'" : "the calibration " + machine.camera_calibration;
}

// Whether a pixel has a ray, and none between it and the optical axis is imaged farther out than a later one: there two rays would share a pixel.
bool has_one_ray(const scan::CameraModel& model, const Vec2& pixel) {
  constexpr int steps = 32;
  const std::optional<Vec3> ray = model.ray(pixel);
  if (!ray) return false;
  const Vec2 middle(model.intrinsics().cx, model.intrinsics().cy);
  double before_px = 0;
  for (int i = 1; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps / ray->z();
    const std::optional<Vec2> at = model.project(Vec3(share * ray->x(), share * ray->y(), 1));
    if (!at || (*at - middle).norm() <= before_px) return false;
    before_px = (*at - middle).norm();
  }
  return true;
}

// Looked at from the axis to each part of the border, and 8 px beyond: the true lens may be off its calibration by 3 px and 0.3 %.
bool folds_over(const scan::CameraModel& model) {
  constexpr int step_px = 16, margin_px = 8;
  const CameraIntrinsics& c = model.intrinsics();
  const int right = c.width + margin_px, low = c.height + margin_px;
  const auto folds = [&](int u, int v) { return !has_one_ray(model, Vec2(u, v)); };
  for (int u = -margin_px; u <= right; u += step_px) {
    if (folds(u, -margin_px) || folds(u, low)) return true;
  }
  for (int v = -margin_px; v <= low; v += step_px) {
    if (folds(-margin_px, v) || folds(right, v)) return true;
  }
  return folds(right, low);
}

struct Sighted {
  const char* what;
  Vec3 in_panel_m;
  const char* keys;  // that put it there on the panel, as the end of a list
};

// Empty: it is in the picture.
std::string why_unseen(const Machine& machine, const CameraCalibration& camera, const Sighted& point) {
  const Vec3 in_camera = camera.base_from_camera.inverse() * (machine.panel.nominal_base_from_panel() * point.in_panel_m);
  const std::optional<Vec2> pixel = scan::CameraModel(camera.intrinsics).project(in_camera);
  const std::string remedy =
      ": see 'camera.position_m', 'camera.down_deg', 'camera.right_deg', " + lens_keys(machine) + point.keys + place_text(machine.panel);
  const std::string what = point.what;
  if (!pixel) return what + " is behind the camera" + remedy;
  const bool inside =
      pixel->x() >= 0 && pixel->x() <= camera.intrinsics.width - 1 && pixel->y() >= 0 && pixel->y() <= camera.intrinsics.height - 1;
  if (inside) return "";
  char text[64];
  std::snprintf(text, sizeof text, " is out of the camera's view, at pixel %.0f, %.0f", pixel->x(), pixel->y());
  return what + text + remedy;
}

}  // namespace

std::vector<std::string> view_problems(const Machine& machine, const CameraCalibration& camera) {
  // Where points fold over, their pixels say nothing.
  if (folds_over(scan::CameraModel(camera.intrinsics)))
    return {"this lens folds its picture over, so that some pixels have no ray or several: see " + lens_keys(machine)};
  const PanelLayout& panel = machine.panel;
  const Vec2 low = panel.plate_min_m, high = panel.plate_max_m;
  const char* both = ", 'panel.plate_min_m' and 'panel.plate_max_m'";
  const std::array<Sighted, 6> points{{
      {"the panel's upper left corner", Vec3(low.x(), high.y(), 0), both},
      {"the panel's upper right corner", Vec3(high.x(), high.y(), 0), " and 'panel.plate_max_m'"},
      {"the panel's lower right corner", Vec3(high.x(), low.y(), 0), both},
      {"the panel's lower left corner", Vec3(low.x(), low.y(), 0), " and 'panel.plate_min_m'"},
      {"the marker", Vec3(panel.marker_centre_m.x(), panel.marker_centre_m.y(), 0), " and 'panel.marker_centre_m'"},
      {"the valve", Vec3(0, 0, panel.handle_height_m), " and 'panel.handle_height_m'"},
  }};
  std::vector<std::string> problems;
  for (const Sighted& point : points) {
    if (std::string why = why_unseen(machine, camera, point); !why.empty()) problems.push_back(std::move(why));
  }
  return problems;
}

}  // namespace lf::config
