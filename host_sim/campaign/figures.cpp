#include "host_sim/campaign/figures.hpp"

#include <array>
#include <cmath>

namespace lf::campaign {
namespace {

using Run = record::RunResult;

double valve_final_deg(const Run& run) {
  double worst = record::unknown;
  for (const record::TaskRecord& task : run.tasks) {
    if (task.task == "turn_valve" && task.done) worst = std::fmax(worst, std::abs(task.reached_deg - task.target_deg));
  }
  return worst;
}

constexpr Figure::Good more = Figure::Good::more, less = Figure::Good::less;

const std::array all{
    Figure{"plane_normal_deg", "panel's normal", "deg", [](const Run& r) { return r.errors.plane_normal_deg; }},
    Figure{"plane_offset_mm", "panel's distance", "mm", [](const Run& r) { return r.errors.plane_offset_mm; }},
    Figure{"panel_over_doubt", "panel's place over the room kept for it", "", [](const Run& r) { return r.errors.panel_over_doubt; }},
    Figure{"valve_base_mm", "valve's base", "mm", [](const Run& r) { return r.errors.valve_base_mm; }},
    Figure{"handle_angle_deg", "handle's angle", "deg", [](const Run& r) { return r.errors.handle_angle_deg; }},
    Figure{"valve_final_deg", "valve's final angle", "deg", valve_final_deg},
    Figure{"cloud_truth_median_mm", "cloud to the true surface, median", "mm", [](const Run& r) { return r.errors.cloud_truth_median_mm; }},
    Figure{"cloud_truth_p95_mm", "cloud to the true surface, 95 %", "mm", [](const Run& r) { return r.errors.cloud_truth_p95_mm; }},
    Figure{"peak_rms_px", "stripe peaks, rms", "px", [](const Run& r) { return r.errors.peak_rms_px; }},
    Figure{"peak_rms_smooth_px", "stripe peaks away from edges, rms", "px", [](const Run& r) { return r.errors.peak_rms_smooth_px; }},
    Figure{"peak_rms_over_bound", "stripe peaks clear of noise and marks, rms over its bound", "",
           [](const Run& r) { return r.errors.peak_rms_clear_px / r.errors.peak_bound_px; }},
    Figure{"peak_rms_at_marks_px", "stripe peaks at marks, rms", "px", [](const Run& r) { return r.errors.peak_rms_at_marks_px; }},
    Figure{"peak_recall", "stripe peaks found", "", [](const Run& r) { return r.errors.peak_recall; }, more},
    Figure{"peaks_false", "false peaks", "", [](const Run& r) { return r.errors.peaks_false; }},
    Figure{"contact_force_n", "peak contact force", "N", [](const Run& r) { return r.contact.peak_force_n; }},
    Figure{"simulated_s", "simulated time", "s", [](const Run& r) { return r.time.simulated_s; }},
    Figure{"real_time_factor", "times real time", "x", [](const Run& r) { return r.time.real_time_factor; }, more, true},
    Figure{"tick_p999_us", "core tick, 99.9 %", "us", [](const Run& r) { return r.core.tick_us.p999; }, less, true},
};

}  // namespace

std::span<const Figure> figures() { return all; }

std::vector<double> figures_of(const record::RunResult& result) {
  std::vector<double> values;
  values.reserve(all.size());
  for (const Figure& figure : all) values.push_back(figure.of(result));
  return values;
}

double compare_worse(const Figure& figure, double a, double b) { return figure.good == more ? b - a : a - b; }

}  // namespace lf::campaign
