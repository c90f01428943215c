#include "tests/unit/vision/panel_cloud.hpp"

#include <cmath>
#include <random>

namespace lf::vision::test {
namespace {

// Height of the surface that a ray straight at the panel meets.
double surface_height_m(const PanelCloudScene& scene, const Vec2& p) {
  const PanelLayout& layout = scene.layout;
  const PanelLayout::Valve& valve = layout.valves[0];
  const double c = std::cos(scene.handle_angle_rad), s = std::sin(scene.handle_angle_rad);
  const double along = -s * p.x() + c * p.y(), across = c * p.x() + s * p.y();
  const bool on_handle = std::abs(along) <= valve.handle_length_m / 2 && std::abs(across) <= valve.handle_thickness_m / 2;
  if (on_handle) return valve.handle_height_m + valve.handle_thickness_m / 2;
  for (const PanelLayout::Button& button : layout.buttons) {
    if ((p - button.at_m).cwiseAbs().maxCoeff() <= button.width_m / 2) return button.height_m;
  }
  return 0;
}

}  // namespace

std::vector<CloudPoint> panel_cloud(const PanelCloudScene& scene) {
  constexpr double stripe_m = 0.0026, step_m = 0.0020;
  std::mt19937 random(scene.seed);
  std::uniform_real_distribution<double> share(0, 1);
  std::normal_distribution<double> noise;
  const PanelLayout& layout = scene.layout;
  const PanelLayout::Valve& valve = layout.valves[0];
  std::vector<CloudPoint> cloud;
  const auto add = [&](double x, double y, double height) {
    cloud.push_back({(scene.base_from_panel * Vec3(x, y, height)).cast<float>(), 100});
  };
  const double phase = stripe_m * share(random);
  const double camera_flank = valve.handle_thickness_m / 2;
  for (double stripe = layout.plate_min_m.y() + phase; stripe < layout.plate_max_m.y(); stripe += stripe_m) {
    const double shift = scene.stripe_noise_m * noise(random);
    for (double x = layout.plate_min_m.x() + step_m * share(random); x < layout.plate_max_m.x(); x += step_m) {
      const double depth_noise = scene.noise_m * noise(random);
      // Triangulation moves a point along its camera ray: height and place on the panel change together.
      add(x, stripe + shift + depth_noise, surface_height_m(scene, {x, stripe}) + depth_noise);
    }
    // The handle's flank that the camera sees, a point each few stripes.
    const double c = std::cos(scene.handle_angle_rad), s = std::sin(scene.handle_angle_rad);
    for (int i = 0; i < 2; ++i) {
      const double along = valve.handle_length_m * (share(random) - 0.5);
      if (share(random) < 0.1) add(-c * camera_flank - s * along, -s * camera_flank + c * along, 0.094 + 0.012 * share(random));
    }
    if (std::abs(stripe) < valve.stem_radius_m) add(-valve.stem_radius_m, stripe, 0.02 + 0.06 * share(random));
  }
  for (int i = 0; i < scene.stray_points; ++i) add(0.8 * (share(random) - 0.5), 0.6 * share(random) - 0.378, 0.15 * share(random));
  return cloud;
}

PlaneFit true_fit(const PanelCloudScene& scene) {
  const Vec3 normal = scene.base_from_panel.linear().col(2);
  return {true, {normal, -normal.dot(scene.base_from_panel.translation())}, 100, 90, 0.0006};
}

}  // namespace lf::vision::test
