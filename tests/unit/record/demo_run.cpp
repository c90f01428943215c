#include "tests/unit/record/demo_run.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "host_sim/record/png.hpp"

namespace lf::record::test {
namespace {

RunResult demo_result() {
  RunResult result;
  result.scenario = "panel_valve_and_buttons";
  result.seed = 7;
  result.version = "0.1.0";
  result.success = true;
  result.drawn = {{"valve_friction_nm", {1.5}}, {"docking_shift_m", {0.004, -0.012, 0.019}}};
  const char* names[] = {"boot",       "home",         "unfold",     "sweep",        "rebuild panel", "reach valve", "grip",
                         "turn valve", "verify valve", "press left", "press centre", "press right",   "look again",  "stow"};
  const double lengths_s[] = {1.2, 3.1, 6.5, 19.8, 0.7, 9.4, 2.2, 12.6, 1.4, 7.7, 5.9, 6.1, 20.3, 8.8};
  double t = 0;
  for (std::size_t i = 0; i < std::size(names); ++i) {
    result.phases.push_back({names[i], t, t + lengths_s[i], i == 6 ? "retried" : "done"});
    t += lengths_s[i];
  }
  result.tasks = {{"turn_valve", "", "", 0, 90, 89.1, true},
                  {"press_button", "", "left", 1, unknown, unknown, true},
                  {"press_button", "", "centre", 1, unknown, unknown, true}};
  result.errors = {0.061, 0.42, 1.31, 0.44, 0.58, 1.72, 0.124, 0.083, 0.991};
  result.contact = {38.2, 0};
  result.core.heap_calls = 0;
  result.core.controller_bytes = 412'336;
  result.core.tick_us = {4.1, 11.9, 21.5, 63.0};
  result.core.frame_us = {310, 402, 440, 512};
  result.core.rejected_inputs = {{"images_unexpected", 0}, {"peaks_ambiguous", 412}, {"can_unknown_node", 0}};
  result.bus = {34.9, 33.4, 36.3, 318'244, 0};
  result.host = {"avx2", 2, "release, GCC 12.2"};
  result.time = {t, t / 9.3, 9.3};
  result.faults = {{31.5, 33.25, 4, "sweep", "image lost", "image lost", "count"},
                   {55.125, 55.125, 1, "grip", "slip", "grip slipped on the handle", "retry"}};
  result.digest = std::string(64, 'a');
  return result;
}

ReportPicture stripe_picture(int index) {
  std::mt19937 random(static_cast<unsigned>(index));
  std::vector<std::uint8_t> pixels(640 * 480);
  std::vector<PixelPoint> peaks;
  for (int u = 0; u < 640; ++u) {
    const bool proud = u > 280 && u < 330;
    const double v0 = 120.0 + 60 * index + 0.06 * u - (proud ? 46 : 0);
    peaks.push_back({static_cast<float>(u), static_cast<float>(v0)});
    for (int v = 0; v < 480; ++v) {
      const double d = (v - v0) / 2.0;
      const double grey = 18 + 0.03 * v + 20 * std::exp(-d * d / 60) + 150 * std::exp(-d * d / 2) + static_cast<double>(random() % 7) - 3;
      pixels[static_cast<std::size_t>(v * 640 + u)] = static_cast<std::uint8_t>(std::clamp(grey, 0.0, 255.0));
    }
  }
  const RgbImage overlay = overlay_peaks({pixels.data(), 640, 480, 640}, peaks, 1.4f);
  return {"Stripe at " + std::to_string(12 + 4 * index) + " s", "Detected peaks in red: 631 of 640 columns.", encode_jpeg(overlay)};
}

// Stripes 2.6 mm apart over plate, handle and buttons, in the base frame.
std::vector<CloudPoint> demo_cloud() {
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, 0.0006f);
  std::vector<CloudPoint> cloud;
  for (float up = -0.378f; up < 0.222f; up += 0.0026f) {
    for (float right = -0.4f; right < 0.4f; right += 0.0016f) {
      float height = 0;
      const float along = std::cos(0.4f) * up - std::sin(0.4f) * right, across = std::sin(0.4f) * up + std::cos(0.4f) * right;
      if (std::abs(along) < 0.0483f && std::abs(across) < 0.0063f) height = 0.106f;
      for (const auto& [x, y] : {std::pair{-0.064f, 0.137f}, {0.f, 0.185f}, {0.064f, 0.137f}}) {
        if (std::abs(right - x) < 0.02f && std::abs(up - y) < 0.02f) height = 0.030f;
      }
      cloud.push_back({Eigen::Vector3f(0.44f - height + noise(random) + 0.01f * right, right, 0.592f - up), 120});
    }
  }
  return cloud;
}

ReportChart joints_chart(double end_s) {
  ReportChart chart{"Joint positions", "rad", {}};
  const char* names[] = {"slew", "shoulder", "elbow", "jaw rotate", "jaw"};
  for (int joint = 0; joint < 5; ++joint) {
    ReportSeries series{names[joint], {}, {}, false};
    for (double t = 0; t < end_s; t += 0.02) {
      series.t_s.push_back(t);
      series.value.push_back(0.4 * joint + 0.5 * std::sin(0.07 * t * (joint + 1)));
    }
    chart.series.push_back(series);
  }
  return chart;
}

ReportChart noisy_chart(const std::string& title, const std::string& unit, const std::vector<std::string>& names, double level,
                        double end_s) {
  std::mt19937 random(11);
  ReportChart chart{title, unit, {}};
  for (const std::string& name : names) {
    ReportSeries series{name, {}, {}, name == "target"};
    for (double t = 0; t < end_s; t += 0.05) {
      series.t_s.push_back(t);
      const double burst = std::fmod(t, 40) > 34 ? 2 : 1;
      series.value.push_back(t > 50 && t < 53 ? unknown : level * burst * (0.8 + 0.2 * std::sin(t / 3) + 0.0004 * (random() % 200)));
    }
    chart.series.push_back(series);
    level *= 0.8;
  }
  return chart;
}

// A mast that turns, an arm that slides out of it, and a panel that stands still.
ReportMotion demo_motion(double end_s) {
  ReportMotion motion;
  motion.parts.resize(3);
  motion.parts[0].name = "mast";
  motion.parts[0].coordinate = 0;
  motion.parts[1].name = "arm";
  motion.parts[1].parent = 0;
  motion.parts[1].parent_from_part.translation() = Vec3(0.1, 0, 0.4);
  motion.parts[1].coordinate = 1;
  motion.parts[1].slides = true;
  motion.parts[1].axis = Vec3::UnitX();
  motion.parts[2].name = "panel";
  motion.parts[2].group = PartGroup::panel;
  motion.parts[2].parent_from_part.translation() = Vec3(0.44, 0, 0.4);
  const Vec3 sizes[] = {Vec3(0.06, 0.06, 0.9), Vec3(0.3, 0.04, 0.04), Vec3(0.02, 0.8, 0.6)};
  for (std::size_t i = 0; i < motion.parts.size(); ++i) {
    scene::Shape shape;
    shape.size_m = sizes[i];
    shape.albedo = {0.8f, 0.5f, 0.1f};
    motion.parts[i].shapes = {shape};
  }
  motion.coordinates = {{"turn", {}}, {"reach", {}}};
  for (double t = 0; t < end_s; t += 0.04) {
    motion.t_s.push_back(t);
    motion.coordinates[0].value.push_back(0.8 * std::sin(0.3 * t));
    motion.coordinates[1].value.push_back(0.1 + 0.05 * std::cos(0.7 * t));
  }
  motion.tool_part = 1;
  motion.tool_m = Vec3(0.15, 0, 0);
  return motion;
}

}  // namespace

ReportData demo_run() {
  ReportData data;
  data.result = demo_result();
  data.command = "lanternfish run panel_valve_and_buttons --seed 7 --set water.attenuation_per_m=0.42";
  data.conditions = {{"panel's offset", "(12.1, -7.4, 3.3) mm"},
                     {"panel's turn", "(0.4, -1.2, 1.9)°"},
                     {"valve's start angle", "-23.4°"},
                     {"friction torque", "1.82 N m"},
                     {"attenuation", "0.42 per m"},
                     {"camera noise", "2.1 grey levels"},
                     {"lamp", "on"}};
  data.errors = report_errors(data.result, 0.42);
  for (int i = 0; i < 4; ++i) data.pictures.push_back(stripe_picture(i));
  data.cloud = demo_cloud();
  data.fit = {true, {Vec3(-1, 0.01, 0).normalized(), 0.43998}, 71'000, 66'812, 0.00058};
  const double end_s = data.result.time.simulated_s;
  data.charts = {joints_chart(end_s), noisy_chart("Joint torques", "N m", {"slew", "shoulder", "elbow", "jaw rotate", "jaw"}, 30, end_s),
                 noisy_chart("CAN bus load", "%", {"can0"}, 35, end_s),
                 noisy_chart("Contact force", "N", {"gripper", "target"}, 12, end_s)};
  data.motion = demo_motion(end_s);
  return data;
}

}  // namespace lf::record::test
