#include "hal/config/view_check.hpp"

#include <algorithm>
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

constexpr double least_stretch = 0.01;  // the renderer takes nothing below

// Whether a pixel has a ray, and the picture does not fold over between it and the optical axis: there two rays would share a pixel.
bool has_one_ray(const scan::CameraModel& model, const Vec2& pixel) {
  constexpr int steps = 16;
  const std::optional<Vec3> ray = model.ray(pixel);
  if (!ray) return false;
  const Vec2 end(ray->x() / ray->z(), ray->y() / ray->z());
  for (int i = 1; i <= steps; ++i) {
    if (!(model.stretch(end * (static_cast<double>(i) / steps)) > least_stretch)) return false;
  }
  return true;
}

// Looked at all over the picture, and 8 px beyond: the true lens may be off its calibration by 3 px, 0.5 % and some px of distortion.
bool lacks_rays(const scan::CameraModel& model) {
  constexpr int step_px = 16, margin_px = 8;  // some 1300 pixels
  const CameraIntrinsics& c = model.intrinsics();
  for (int v = -margin_px; v < c.height + margin_px + step_px; v += step_px) {
    for (int u = -margin_px; u < c.width + margin_px + step_px; u += step_px) {
      if (!has_one_ray(model, Vec2(std::min(u, c.width + margin_px), std::min(v, c.height + margin_px)))) return true;
    }
  }
  return false;
}

struct Sighted {
  std::string what;
  Vec3 in_panel_m;
  std::string keys;  // that put it there on the panel, as the end of a list
};

// Empty: it is in the picture.
std::string why_unseen(const Machine& machine, const CameraCalibration& camera, const Sighted& point) {
  const Vec3 in_camera = camera.base_from_camera.inverse() * (machine.panel.nominal_base_from_panel() * point.in_panel_m);
  const std::optional<Vec2> pixel = scan::CameraModel(camera.intrinsics).project(in_camera);
  const std::string remedy =
      ": see 'camera.position_m', 'camera.down_deg', 'camera.right_deg', " + lens_keys(machine) + point.keys + place_text(machine.panel);
  const std::string& what = point.what;
  if (!pixel) return what + " is behind the camera" + remedy;
  const bool inside =
      pixel->x() >= 0 && pixel->x() <= camera.intrinsics.width - 1 && pixel->y() >= 0 && pixel->y() <= camera.intrinsics.height - 1;
  // What lies beyond a fold comes back into the picture, at a pixel of another ray.
  const std::optional<Vec3> ray = scan::CameraModel(camera.intrinsics).ray(*pixel);
  if (inside && ray && (*ray - in_camera.normalized()).norm() < 1e-6) return "";
  if (inside) return what + " lies farther aside than this lens images" + remedy;
  char text[64];
  std::snprintf(text, sizeof text, " is out of the camera's view, at pixel %.0f, %.0f", pixel->x(), pixel->y());
  return what + text + remedy;
}

// Of several markers one in the picture is enough: the first, where none is.
std::optional<Sighted> hidden_marker(const Machine& machine, const CameraCalibration& camera) {
  std::optional<Sighted> hidden;
  for (std::size_t i = 0; i < machine.panel.markers.size(); ++i) {
    const Vec2& centre = machine.panel.markers[i].centre_m;
    const Sighted marker{marker_text(machine.survey.names, i), Vec3(centre.x(), centre.y(), 0),
                         " and " + marker_key(machine.survey, i, "at_m")};
    if (why_unseen(machine, camera, marker).empty()) return std::nullopt;
    if (!hidden) hidden = marker;
  }
  return hidden;
}

}  // namespace

std::vector<std::string> view_problems(const Machine& machine, const CameraCalibration& camera) {
  // Without rays the pixels of the points say nothing.
  if (lacks_rays(scan::CameraModel(camera.intrinsics)))
    return {"this lens folds its picture over, or nearly: some of its pixels have no ray of their own. Check " + lens_keys(machine) +
            ", or calibrate with points out to the corners"};
  const PanelLayout& panel = machine.panel;
  const Vec2 low = panel.plate_min_m, high = panel.plate_max_m;
  const PanelSurvey& survey = machine.survey;
  const std::string min = plate_key(survey, "min_m"), max = plate_key(survey, "max_m"), both = ", " + min + " and " + max;
  const std::vector<Sighted> points{
      {"the panel's upper left corner", Vec3(low.x(), high.y(), 0), both},
      {"the panel's upper right corner", Vec3(high.x(), high.y(), 0), " and " + max},
      {"the panel's lower right corner", Vec3(high.x(), low.y(), 0), both},
      {"the panel's lower left corner", Vec3(low.x(), low.y(), 0), " and " + min},
  };
  std::vector<std::string> problems;
  const auto look = [&](const Sighted& point) {
    std::string why = why_unseen(machine, camera, point);
    if (!why.empty()) problems.push_back(std::move(why));
  };
  for (const Sighted& point : points) look(point);
  if (const std::optional<Sighted> hidden = hidden_marker(machine, camera)) look(*hidden);
  for (std::size_t i = 0; i < panel.valves.size(); ++i) {
    if (survey.file.empty() || turns(machine, i))
      look({valve_text(survey.names, i), panel.valves[i].handle_centre_m(), " and " + valve_key(survey, i, "height_m")});
  }
  return problems;
}

}  // namespace lf::config
