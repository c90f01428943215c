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

// Each pixel needs one ray. The true lens is off its calibration, so a margin around the picture, too. What folds over inside does so at the border.
bool folds_over(const scan::CameraModel& model) {
  constexpr int step_px = 4, margin_px = 8;
  const CameraIntrinsics& c = model.intrinsics();
  const int right = c.width + margin_px, low = c.height + margin_px;
  for (int u = -margin_px; u <= right; u += step_px) {
    if (!model.ray(Vec2(u, -margin_px)) || !model.ray(Vec2(u, low))) return true;
  }
  for (int v = -margin_px; v <= low; v += step_px) {
    if (!model.ray(Vec2(-margin_px, v)) || !model.ray(Vec2(right, v))) return true;
  }
  return false;
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
    return {"this lens folds its picture over at the border, so that pixels there have no ray or two: see " + lens_keys(machine)};
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
