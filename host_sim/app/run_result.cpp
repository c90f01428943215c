#include "host_sim/app/run_result.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "hal/config/boot_sentence.hpp"
#include "hal/config/cause.hpp"
#include "host_sim/app/outcome_text.hpp"
#include "host_sim/app/scoring.hpp"
#include "host_sim/judge/truth.hpp"
#include "host_sim/scenario/instance.hpp"

namespace lf::app {

namespace {

std::string formatted(const char* format, double a, double b = 0, double c = 0) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b, c);
  return text;
}

}  // namespace

std::optional<record::FailureRecord> failure_of(const Controller& controller, const config::ErrorTexts& texts, const world::World& world,
                                                const RunRecorder& recorder, const scenario::Scenario& scenario, bool interrupted) {
  const mission::Outcome& outcome = controller.mission().outcome();
  if (outcome.ended && outcome.success) return std::nullopt;
  const std::string boot =
      outcome.fault == safety::Fault::boot_failed ? config::boot_sentences(controller.network().boot(), texts.names()) : "";
  if (outcome.ended) {
    const mission::Sight& sight = controller.mission().sight();
    record::FailureRecord failure{outcome.stage, reason_of(outcome, texts, sight) + boot};
    const config::Cause cause = config::cause_of(outcome.fault, outcome.code, sight);
    failure.cause = cause.name;
    failure.remedy = cause.remedy;
    if (outcome.fault == safety::Fault::vision_poor) failure.seen = config::sight_text(sight);
    return failure;
  }
  if (interrupted) return record::FailureRecord{recorder.phases().stage(), "interrupted"};
  return record::FailureRecord{recorder.phases().stage(),
                               formatted("not ended by the time limit of %g s, at %.1f s", scenario.time_limit_s, world.time_s())};
}

std::optional<record::FailureRecord> disagreement(const Controller& controller, const world::World& world, const RunRecorder& recorder,
                                                  const PanelNames& names) {
  const auto& results = controller.mission().tasks();
  const auto wrong = judge::contradiction({results.data(), results.size()}, recorder.truth().watched(world), world.contacts(), names);
  if (!wrong) return std::nullopt;
  return record::FailureRecord{wrong->phase, wrong->reason};
}

std::optional<record::CalibrationRecord> calibration_of(const CalibrationObserver& looks, const mission::TaskResults& results) {
  if (!looks.record()) return std::nullopt;
  record::CalibrationRecord all = *looks.record();
  if (const std::optional<double> off_m = config::faces_off_m(results)) all.faces_off_mm = 1e3 * *off_m;
  const config::Cause doubt = config::calibration_cause(looks.worst_fit(), results);
  all.doubt = doubt.name;
  all.remedy = doubt.remedy;
  return all;
}

std::vector<record::TaskRecord> task_records(const Controller& controller, const world::World& world, const RunRecorder& recorder,
                                             const PanelNames& names) {
  std::vector<record::TaskRecord> records;
  const auto& results = controller.mission().tasks();
  const std::vector<judge::TaskTruth> truths = judge::completed(recorder.truth().tasks(), results.size(), judge::task_truth(world));
  const std::vector<bool> done = judge::truly_done({results.data(), results.size()}, truths);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const mission::TaskResult& result = results[i];
    const judge::TaskTruth& truth = truths[i];
    record::TaskRecord task;
    if (result.task.kind == mission::Task::Kind::turn_valve) {
      task.task = "turn_valve";
      if (names.valves.size() > 1) task.valve = names.valves.at(result.task.valve);
      task.target_deg = deg_from_rad(result.task.to_rad);
      task.reached_deg = deg_from_rad(truth.valves_rad.at(result.task.valve));
    } else {
      task.task = "press_button";
      task.button = names.buttons.at(result.task.button);
      task.presses = static_cast<int>(truth.presses.at(result.task.button));
      if (result.attempted) task.travel_mm = 1e3 * result.travel_m;
      task.click_felt = result.click_felt;
      if (result.failure != StepFailure::none) task.failure = name(result.failure);
    }
    task.done = done[i];
    records.push_back(task);
  }
  return records;
}

std::vector<std::string> faults_not_made(const scenario::Scenario& scenario, const hal::SimPlatform& platform) {
  std::vector<std::string> missed;
  for (const config::Fault& fault : scenario.faults) {
    double begins_s = fault.at_s;
    if (!fault.at_step.empty()) {
      const std::optional<Time> step = platform.entered(scenario::sim_fault(fault, scenario.drives, scenario.joints).at_step);
      begins_s = step ? step->s() + fault.after_s : HUGE_VAL;
    }
    if (begins_s <= platform.now().s()) continue;
    char when[48];
    std::snprintf(when, sizeof when, ", at %g s", fault.at_s);
    missed.push_back(fault.kind + (fault.node.empty() ? "" : " " + fault.node) +
                     (fault.at_step.empty() ? when : ", at step " + fault.at_step));
  }
  return missed;
}

record::ErrorRecord score(const RunRecorder& recorder, const hal::SimConfig& truth) {
  record::ErrorRecord errors;
  errors.peak_rms_px = recorder.peaks().rms_px();
  errors.peak_rms_smooth_px = recorder.peaks().smooth_rms_px();
  errors.peak_rms_clear_px = recorder.peaks().clear_rms_px();
  errors.peak_bound_px = recorder.peaks().clear_bound_px();
  errors.peak_rms_at_marks_px = recorder.peaks().marks_rms_px();
  errors.peak_recall = recorder.peaks().recall();
  errors.peaks_false = recorder.peaks().false_share();
  errors.peaks_elsewhere = recorder.peaks().elsewhere_share();
  if (!recorder.panel().located()) return errors;
  const Located& located = *recorder.panel().located();
  const Pose& base_from_panel = truth.world.base_from_panel;
  const PlaneFit& fit = located.panel.fit;
  errors.plane_normal_deg = plane_normal_error_deg(fit.plane, base_from_panel);
  errors.plane_offset_mm = plane_offset_error_mm(fit.plane, base_from_panel, truth.world.layout);
  errors.panel_over_doubt = recorder.panel().worst_over_doubt();
  for (const Located::Handle& handle : located.handles)  // the worst
    errors.handle_angle_deg = std::fmax(errors.handle_angle_deg, handle_error_deg(handle.found_rad, handle.true_rad));
  errors.valve_base_mm = 1e3 * (located.base_from_panel.translation() - base_from_panel.translation()).norm();
  const std::vector<double> cloud_mm = cloud_errors_mm(located.cloud, truth.world.scene, located.poses);
  errors.cloud_truth_median_mm = percentile(cloud_mm, 0.5);
  errors.cloud_truth_p95_mm = percentile(cloud_mm, 0.95);
  return errors;
}

std::map<std::string, std::uint64_t> rejected_inputs(const Controller& controller, const ScanPipeline& pipeline,
                                                     const hal::CoreRings& rings) {
  std::map<std::string, std::uint64_t> all;
  const canopen::NetworkStats stats = controller.network().stats();
  for (std::size_t i = 0; i < canopen::refusal_count; ++i)
    all[std::string("can: ") + canopen::name(static_cast<canopen::Refusal>(i))] = stats.refused[i];
  all["controller"] = controller.rejected_inputs();
  all["images unexpected"] = pipeline.stats().images_unexpected;
  all["images refused"] = pipeline.stats().images_refused;
  all["images repeated"] = pipeline.stats().images_repeated;
  all["images missing"] = pipeline.stats().images_missing;
  all["scan orders refused"] = pipeline.stats().commands_refused;
  all["points overflowed"] = pipeline.stats().points_overflowed;
  all["rings overflowed"] = rings.scan_commands.lost() + rings.scan_stats.lost();
  return all;
}

std::vector<std::pair<std::string, std::string>> conditions(const scenario::Sample& s) {
  const auto mm = [](const Vec3& v) { return formatted("[%.1f, %.1f, %.1f] mm", 1e3 * v.x(), 1e3 * v.y(), 1e3 * v.z()); };
  const auto deg = [](const Vec3& v) {
    return formatted("[%.2f, %.2f, %.2f] deg", deg_from_rad(v.x()), deg_from_rad(v.y()), deg_from_rad(v.z()));
  };
  const auto mm2 = [](const Vec3& v) { return formatted("[%+.2f, %+.2f, %+.2f] mm", 1e3 * v.x(), 1e3 * v.y(), 1e3 * v.z()); };
  const auto percents = [](const Vec3& ratios) {
    const Vec3 percent = 100 * (ratios.array() - 1);
    return formatted("%+.0f, %+.0f, %+.0f %%", percent.x(), percent.y(), percent.z());
  };
  double worst_button_m = 0;
  for (const scenario::Sample::Button& button : s.buttons) worst_button_m = std::max(worst_button_m, button.shift_m.norm());
  const auto each = [](const auto& features, const auto& text) {
    std::string list;
    for (const auto& feature : features) list += (list.empty() ? "" : "; ") + text(feature);
    return list.empty() ? std::string("none") : list;
  };
  return {
      {"docking error, shift", mm(s.docking_shift_m)},
      {"docking error, turn", deg(s.docking_turn_rad)},
      {"valve's start angle", each(s.valves, [](const auto& valve) { return formatted("%.1f deg", deg_from_rad(valve.start_rad)); })},
      {"friction torque", each(s.valves, [](const auto& valve) { return formatted("%.2f N m", valve.friction_nm); })},
      {"attenuation", formatted("%.2f per m", s.attenuation_per_m)},
      {"particles", formatted("%.1f per litre", s.particles_per_l)},
      {"scattering and phase function off by",
       percents({s.scattering_ratio, s.forward_ratio[0], s.back_ratio}) + " (all, first forward term, back)"},
      {"camera noise", formatted("%.1f grey levels", s.camera_noise_grey) + formatted(", %.0f electrons a level", s.electrons_per_grey)},
      {"exposure", formatted("%.2f ms late", 1e3 * s.exposure_delay_s) + formatted(", jitter %.2f %%", 100 * s.exposure_jitter) +
                       formatted(", time stamps off by %.2f ms", 1e3 * s.stamp_s)},
      {"lens", formatted("focal length %+.3f %%, ", 100 * (s.focal_ratio - 1)) +
                   formatted("principal point [%+.2f, %+.2f] px, ", s.principal_point_px.x(), s.principal_point_px.y()) +
                   formatted("distortion %.2f px, spot %+.0f %%, ", s.distortion_px.norm(), 100 * (s.lens_ratio - 1)) +
                   formatted("%.2f times as wide in the corners", s.corner_blur)},
      {"ghost", formatted("%.2f %% of the light, %.0f px away", 100 * s.ghost_share, s.ghost_px)},
      {"laser's light", formatted("speckle %.2f, waist at %+.2f m, ", s.speckle, s.waist_at_m) +
                            formatted("lobe of %.1f %% at %+.1f sigma, ", 100 * s.lobe_share, s.lobe_sigmas) +
                            formatted("beam %+.0f %%, cone %+.1f mrad", 100 * (s.beam_ratio - 1), 1e3 * s.laser_cone_rad)},
      {"lamps", s.lamps_lit ? "on" : "off"},
      {"camera's mounting error", formatted("%.2f mm, %.3f deg", 1e3 * s.camera_shift_m.norm(), deg_from_rad(s.camera_turn_rad.norm()))},
      {"laser's mounting error", formatted("%.2f mm, %.3f deg", 1e3 * s.laser_shift_m.norm(), deg_from_rad(s.laser_turn_rad.norm()))},
      {"marker's side off by", each(s.markers,
                                    [](const auto& marker) {
                                      return formatted("%+.2f mm, ", 1e3 * marker.size_m) +
                                             formatted("its edges off the panel by %.2f mm", 1e3 * marker.flat_m.norm());
                                    })},
      {"handle's size off by", each(s.valves, [&](const auto& valve) { return mm2(valve.size_m); })},
      {"buttons' place off by at most", formatted("%.2f mm", 1e3 * worst_button_m)}};
}

namespace {

std::vector<double> phase_percent(const scenario::Sample& s) {
  std::vector<double> percent;
  for (const double ratio : s.forward_ratio) percent.push_back(100 * (ratio - 1));
  percent.push_back(100 * (s.back_ratio - 1));
  return percent;
}

}  // namespace

record::DrawnRecord drawn(const scenario::Sample& s, std::size_t joints) {
  const auto metres = [](const Vec3& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  const auto degrees = [](const Vec3& v) { return std::vector<double>{deg_from_rad(v.x()), deg_from_rad(v.y()), deg_from_rad(v.z())}; };
  std::vector<double> joint_offset_deg;
  for (std::size_t i = 0; i < joints; ++i) joint_offset_deg.push_back(deg_from_rad(s.joint_offset_rad[i]));
  // Of the docked mission's buttons one size is drawn, of a file's each has its own: equal ones are told once.
  std::vector<double> start_deg, friction_nm, handle_m, button_shift_m, button_size_m, marker_shift_m, marker_turn_deg, marker_size_m,
      marker_flat_m;
  const auto add = [](std::vector<double>& list, std::initializer_list<double> values) { list.insert(list.end(), values); };
  for (const scenario::Sample::Valve& valve : s.valves) {
    add(start_deg, {deg_from_rad(valve.start_rad)});
    add(friction_nm, {valve.friction_nm});
    add(handle_m, {valve.size_m.x(), valve.size_m.y(), valve.size_m.z()});
  }
  const bool alike =
      std::all_of(s.buttons.begin(), s.buttons.end(), [&](const auto& button) { return button.size_m == s.buttons[0].size_m; });
  for (const scenario::Sample::Button& button : s.buttons) {
    add(button_shift_m, {button.shift_m.x(), button.shift_m.y()});
    if (!alike || button_size_m.empty()) add(button_size_m, {button.size_m.x(), button.size_m.y()});
  }
  for (const scenario::Sample::Marker& marker : s.markers) {
    add(marker_shift_m, {marker.shift_m.x(), marker.shift_m.y(), marker.shift_m.z()});
    add(marker_turn_deg, {deg_from_rad(marker.turn_rad)});
    add(marker_size_m, {marker.size_m});
    add(marker_flat_m, {marker.flat_m.x(), marker.flat_m.y()});
  }
  return {{"docking_shift_m", metres(s.docking_shift_m)},
          {"docking_turn_deg", degrees(s.docking_turn_rad)},
          {"valve_start_deg", std::move(start_deg)},
          {"valve_friction_nm", std::move(friction_nm)},
          {"attenuation_per_m", {s.attenuation_per_m}},
          {"camera_noise_grey", {s.camera_noise_grey}},
          {"lamps_lit", {s.lamps_lit ? 1.0 : 0.0}},
          {"camera_shift_m", metres(s.camera_shift_m)},
          {"camera_turn_deg", degrees(s.camera_turn_rad)},
          {"laser_shift_m", metres(s.laser_shift_m)},
          {"laser_turn_deg", degrees(s.laser_turn_rad)},
          {"joint_offset_deg", std::move(joint_offset_deg)},
          {"marker_shift_m", std::move(marker_shift_m)},
          {"marker_turn_deg", std::move(marker_turn_deg)},
          {"principal_point_px", {s.principal_point_px.x(), s.principal_point_px.y()}},
          {"focal_percent", {100 * (s.focal_ratio - 1)}},
          {"distortion_px", metres(s.distortion_px)},
          {"lens_percent", {100 * (s.lens_ratio - 1)}},
          {"laser_cone_mrad", {1e3 * s.laser_cone_rad}},
          {"beam_percent", {100 * (s.beam_ratio - 1)}},
          {"button_shift_m", std::move(button_shift_m)},
          {"exposure_delay_ms", {1e3 * s.exposure_delay_s}},
          {"stamp_ms", {1e3 * s.stamp_s}},
          {"handle_m", std::move(handle_m)},
          {"button_size_m", std::move(button_size_m)},
          {"marker_size_m", std::move(marker_size_m)},
          {"marker_flat_m", std::move(marker_flat_m)},
          {"scattering_percent", {100 * (s.scattering_ratio - 1)}},
          {"phase_percent", phase_percent(s)},
          {"corner_blur", {s.corner_blur}},
          {"electrons_per_grey", {s.electrons_per_grey}},
          {"exposure_jitter", {s.exposure_jitter}},
          {"ghost_share", {s.ghost_share}},
          {"ghost_px", {s.ghost_px}},
          {"speckle", {s.speckle}},
          {"waist_at_m", {s.waist_at_m}},
          {"lobe_share", {s.lobe_share}},
          {"lobe_sigmas", {s.lobe_sigmas}},
          {"fan_low_percent", {100 * s.fan_low_ratio}},
          {"fan_fine_percent", {100 * s.fan_fine_ratio}},
          {"particles_per_l", {s.particles_per_l}}};
}

}  // namespace lf::app
