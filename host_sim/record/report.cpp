#include "host_sim/record/report.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/record/page/page_files.hpp"
#include "host_sim/record/png.hpp"
#include "host_sim/record/report_parts.hpp"

namespace lf::record {
namespace {

std::string valve_of(const TaskRecord& task) { return task.valve.empty() ? "valve" : "valve " + task.valve; }

std::string tile(const std::string& value, const std::string& name) {
  return "<div class=\"tile\"><b>" + escape_html(value) + "</b><span>" + escape_html(name) + "</span></div>";
}

std::string row(const std::string& name, const std::string& value, const char* kind = "n") {
  return "<tr><td>" + escape_html(name) + "</td><td class=\"" + kind + "\">" + escape_html(value) + "</td></tr>";
}

std::string section(const std::string& title, const std::string& content) {
  return content.empty() ? "" : "<section><h2>" + escape_html(title) + "</h2>" + content + "</section>\n";
}

std::string tiles(const ReportData& data) {
  const RunResult& result = data.result;
  std::string html = "<div class=\"tiles\">";
  const auto done = std::count_if(result.tasks.begin(), result.tasks.end(), [](const TaskRecord& task) { return task.done; });
  html += tile(std::to_string(done) + " of " + std::to_string(result.tasks.size()), "tasks done");
  for (const TaskRecord& task : result.tasks) {
    if (task.task == "turn_valve") {
      html += tile(formatted("%.1f°", task.reached_deg),
                   (task.done ? valve_of(task) + " turned to (target " : valve_of(task) + " stands at, not turned to its target (") +
                       formatted("%.0f°", task.target_deg) + ")");
    }
  }
  html += tile(formatted("%.1f s", result.time.simulated_s), "simulated");
  html += tile(formatted("%.1f ×", result.time.real_time_factor), "real time");
  html += tile(formatted("%.1f %%", result.bus.load_percent), "CAN bus load, stuff bits included");
  html += tile(result.core.heap_calls ? std::to_string(*result.core.heap_calls) : "–", "heap calls in the core");
  html += tile(formatted("%.0f µs", result.core.tick_us.p999), "core tick, 99.9 %");
  return html + "</div>";
}

std::string explanation(const FailureRecord& failure) {
  std::string html;
  if (!failure.cause.empty()) html += row("cause", failure.cause, "");
  if (!failure.remedy.empty()) html += row("what to do", failure.remedy, "");
  if (!failure.seen.empty()) html += row("what the look saw", failure.seen, "");
  return html.empty() ? "" : "<table>" + html + "</table>";
}

std::string header(const ReportData& data) {
  const RunResult& result = data.result;
  std::string html = result.success ? "<header class=\"done\">" : "<header class=\"failed\">";
  html += "<h1><span class=\"verdict\">" + std::string(result.success ? "done" : "failed") + "</span>" + escape_html(result.scenario) +
          ", seed " + std::to_string(result.seed) + "</h1>";
  if (result.failure) {
    html +=
        "<p class=\"reason\">In phase <b>" + escape_html(result.failure->phase) + "</b>: " + escape_html(result.failure->reason) + "</p>";
    html += explanation(*result.failure);
  } else if (result.expected_failure) {
    html += "<p class=\"soft\">It failed as the scenario expects, in phase <b>" + escape_html(result.expected_failure->phase) +
            "</b>: " + escape_html(result.expected_failure->reason) + "</p>";
  }
  const std::string& date = result.provenance.date_utc;
  html += "<div class=\"soft\">Lanternfish " + escape_html(result.version) + (date.empty() ? "" : ", " + escape_html(date)) +
          ". The same run again, with the file as it is now:</div><pre>" + escape_html(data.command) +
          "</pre><div class=\"soft\">With the scenario as it was then, resolved, beside this report:</div><pre>" +
          escape_html("lanternfish run ./scenario.yaml --seed " + std::to_string(result.seed)) + "</pre>";
  html += tiles(data);
  if (!data.notes.empty()) {
    html += "<ul>";
    for (const std::string& note : data.notes) html += "<li>" + escape_html(note) + "</li>";
    html += "</ul>";
  }
  return html + "</header>\n";
}

std::string tasks_table(const RunResult& result) {
  if (result.tasks.empty()) return "";
  std::string html = "<table><tr><th>task</th><th class=\"n\">target</th><th class=\"n\">reached</th><th></th></tr>";
  for (const TaskRecord& task : result.tasks) {
    const bool turn = task.task == "turn_valve";
    const std::string name = turn                          ? "turn " + (task.valve.empty() ? "the valve" : valve_of(task))
                             : task.task == "press_button" ? std::string("press button ").append(task.button)
                                                           : task.task;
    const std::string target = turn ? formatted("%.1f°", task.target_deg) : "1 press";
    const std::string reached =
        turn ? formatted("%.1f°", task.reached_deg) : std::to_string(task.presses).append(task.presses == 1 ? " press" : " presses");
    html += "<tr><td>" + escape_html(name) + "</td><td class=\"n\">";
    html += target;
    html += "</td><td class=\"n\">" + reached + "</td><td class=\"mark " + (task.done ? "good\">done" : "bad\">not done") + "</td></tr>";
  }
  return html + "</table>";
}

std::string faults_table(const RunResult& result) {
  if (result.faults.empty()) return "";
  std::string html = "<table><tr><th class=\"n\">at</th><th>in step</th><th>what</th><th>reaction</th><th class=\"n\">times</th></tr>";
  for (const FaultRecord& fault : result.faults) {
    html += "<tr><td class=\"n\" data-t=\"" + formatted("%.6g", fault.t_s) + "\">" + formatted("%.3f s", fault.t_s) + "</td><td>" +
            escape_html(fault.step) + "</td><td>" + escape_html(fault.text) + "</td><td>" + escape_html(fault.reaction) +
            "</td><td class=\"n\">" + std::to_string(fault.times);
    if (fault.times > 1) html += ", to " + formatted("%.3f s", fault.last_s);
    html += "</td></tr>";
  }
  html += "</table>";
  if (result.faults_left_out > 0)
    html += "<p class=\"soft\">And " + std::to_string(result.faults_left_out) + " more: log.jsonl has all.</p>";
  return html;
}

std::string error_row(const ReportError& error) {
  std::string html = "<tr><td>" + escape_html(error.name) + "</td><td class=\"n\">" + formatted("%.3g", error.value) + " " +
                     escape_html(error.unit) + "</td>";
  if (!std::isfinite(error.aim)) return html + "<td class=\"n soft\">–</td><td></td></tr>";
  html += "<td class=\"n\">" + std::string(error.at_least ? "≥ " : "≤ ") + formatted("%.3g", error.aim) + " " + escape_html(error.unit) +
          "</td>";
  if (!std::isfinite(error.value)) return html + "<td class=\"soft\">not measured</td></tr>";
  const bool good = error.at_least ? error.value >= error.aim : error.value <= error.aim;
  // A full meter is the aim; of a lower bound what is missing counts: 99 % with 98 % asked uses half of what may be missing.
  const double used = error.at_least ? (1 - error.value) / std::max(1e-9, 1 - error.aim) : error.value / std::max(1e-9, error.aim);
  html += "<td><span class=\"meter" + std::string(good ? "" : " bad") +
          "\"><i style=\"width:" + formatted("%.0f", 100 * std::clamp(used, 0.0, 1.0)) + "%\"></i></span> <span class=\"mark " +
          (good ? "good\">within" : "bad\">beyond") + "</span></td></tr>";
  return html;
}

std::string errors_table(const std::vector<ReportError>& errors) {
  if (errors.empty()) return "";
  std::string html = "<table><tr><th>against the simulator's truth</th><th class=\"n\">this run</th><th class=\"n\">aim</th><th></th></tr>";
  for (const ReportError& error : errors) html += error_row(error);
  return html + "</table>";
}

const char* kind_of(const ReportPicture& picture) { return picture.file.size() > 1 && picture.file[0] == 0xFF ? "jpeg" : "png"; }

std::string pictures(const std::vector<ReportPicture>& list) {
  if (list.empty()) return "";
  std::string html = "<div class=\"pictures\">";
  for (const ReportPicture& picture : list) {
    html += "<figure><img alt=\"" + escape_html(picture.title) + "\" src=\"data:image/" + kind_of(picture) + ";base64," +
            base64(picture.file) + "\"><figcaption><b>" + escape_html(picture.title) + "</b> <span>" + escape_html(picture.caption) +
            "</span></figcaption></figure>";
  }
  return html + "</div>";
}

// The 3D view beside the charts; on a narrow screen above them.
std::string over_time(const ReportData& data) {
  const std::string cloud = cloud_html(data);
  if (cloud.empty() && data.charts.empty()) return "";
  std::string html = "<div class=\"split\" id=\"split\"><div class=\"stage\">" + cloud + controls_html() + "</div><div class=\"charts\">";
  for (std::size_t i = 0; i < data.charts.size(); ++i) html += chart_figure(data, i);
  return html + "</div></div>";
}

std::string conditions_table(const ReportData& data) {
  if (data.conditions.empty()) return "";
  std::string html = "<table>";
  for (const auto& [name, value] : data.conditions) html += row(name, value);
  return html + "</table>";
}

std::string times_text(const TimesRecord& times) {
  return formatted("%.1f", times.p50) + " / " + formatted("%.1f", times.p99) + " / " + formatted("%.1f", times.p999) + " / " +
         formatted("%.1f µs", times.max);
}

// The core's own account, so not among the errors.
std::string calibration_rows(const CalibrationRecord& fit) {
  std::string html;
  const auto add = [&html](const char* name, const char* format, double value) {
    if (std::isfinite(value)) html += row(std::string("left over: ") + name, formatted(format, value));
  };
  add("the marker's side on the scanned plane", "%+.2f %%", fit.marker_side_percent);
  add("its corners about a square", "%.2f mm", fit.marker_corners_mm);
  add("the plane's bend", "%.2f mm", fit.plane_bend_mm);
  add("the panel's shift between looks", "%.2f mm", fit.panel_shift_mm);
  add("the buttons' faces, felt behind the place where they were seen", "%+.2f mm", fit.faces_off_mm);
  return html;
}

std::string machine_table(const RunResult& result) {
  std::string html = "<table>";
  html += row("core tick: median / 99 % / 99.9 % / maximum", times_text(result.core.tick_us));
  html += row("image to points: the same", times_text(result.core.frame_us));
  html += row("controller's memory", formatted("%.1f kB", static_cast<double>(result.core.controller_bytes) / 1000));
  html += row("CAN load: as sent / without stuff bits / with worst-case stuffing",
              formatted("%.1f", result.bus.load_percent) + " / " + formatted("%.1f", result.bus.load_unstuffed_percent) + " / " +
                  formatted("%.1f %%", result.bus.load_worst_case_percent));
  html += row("CAN frames, of these errors", std::to_string(result.bus.frames) + ", " + std::to_string(result.bus.errors));
  html += row("peak contact force", formatted("%.1f N", result.contact.peak_force_n));
  html += row("unintended contacts", std::to_string(result.contact.unintended_contacts));
  if (result.calibration) html += calibration_rows(*result.calibration);
  html += row("simulated in", formatted("%.2f s", result.time.wall_s));
  std::string none;
  for (const auto& [name, count] : result.core.rejected_inputs) {
    if (count == 0) none += (none.empty() ? "" : ", ") + name;
    if (count != 0) html += row("refused inputs: " + name, std::to_string(count));
  }
  if (!none.empty()) html += row("refused inputs, none of", none, "names");
  html += row("host", result.host.isa + ", " + std::to_string(result.host.threads) + " render threads, " + result.host.build);
  return html + row("digest", result.digest, "code") + "</table>";
}

}  // namespace

std::vector<ReportError> report_errors(const RunResult& result, double attenuation_per_m) {
  // "Clear" is the least attenuation of the spread, 0.1 per m; the aims at 0.8 per m are reached on a straight line.
  const double murk = std::isfinite(attenuation_per_m) ? std::clamp((attenuation_per_m - 0.1) / 0.7, 0.0, 1.0) : 0;
  const ErrorRecord& e = result.errors;
  std::vector<ReportError> errors{{"panel's normal", e.plane_normal_deg, 0.3, "°", false},
                                  {"panel's distance", e.plane_offset_mm, unknown, "mm", false},
                                  {"panel's place, over the room kept for it", e.panel_over_doubt, 1, "", false},
                                  {"valve's base", e.valve_base_mm, 3.0, "mm", false},
                                  {"handle's angle", e.handle_angle_deg, 1.0, "°", false},
                                  {"cloud to the true surface, median", e.cloud_truth_median_mm, unknown, "mm", false},
                                  {"cloud to the true surface, 95 %", e.cloud_truth_p95_mm, 2.5, "mm", false},
                                  {"stripe peaks, rms", e.peak_rms_px, 0.1 + 0.1 * murk, "px", false},
                                  {"stripe peaks away from edges, rms", e.peak_rms_smooth_px, unknown, "px", false},
                                  {"stripe peaks clear of noise and marks, rms", e.peak_rms_clear_px, 1.25 * e.peak_bound_px, "px", false},
                                  {"their bound, by noise and speckle", e.peak_bound_px, unknown, "px", false},
                                  {"stripe peaks at marks, rms", e.peak_rms_at_marks_px, 0.25, "px", false},
                                  {"stripe peaks found", e.peak_recall, 0.97, "", true},
                                  {"false peaks", e.peaks_false, 0.002, "", false}};
  for (const TaskRecord& task : result.tasks) {
    if (task.task == "turn_valve" && task.done)
      errors.push_back({valve_of(task) + "'s final angle", std::abs(task.reached_deg - task.target_deg), 3.0, "°", false});
  }
  return errors;
}

std::string_view report_style() { return page::own_style; }

std::string report_html(const ReportData& data) {
  const RunResult& result = data.result;
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\">";
  // Held by the browser itself: nothing is asked of any network.
  html +=
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'; "
      "script-src 'unsafe-inline'\">";
  html += "<meta name=\"color-scheme\" content=\"light dark\"><title>Lanternfish: " + escape_html(result.scenario) + ", seed " +
          std::to_string(result.seed) + "</title><style>" + page::library_style + "\n" + std::string(report_style()) +
          "</style></head>\n<body><main class=\"run\">\n";
  html += header(data);
  html += section("Phases", timeline_svg(result.phases));
  html += section("Faults and reactions", faults_table(result));
  html += "<div class=\"two\">" + section("Tasks", tasks_table(result)) + section("Conditions drawn by the seed", conditions_table(data)) +
          "</div>\n";
  html += section("Errors", errors_table(data.errors));
  html += section("The run over time", over_time(data));
  html += section("What the camera saw", pictures(data.pictures));
  html += section("Core, bus and host", machine_table(result));
  html += "<footer>Written by lanternfish " + escape_html(result.version) + "; the same figures stand in result.json.</footer>\n";
  html += "</main><script type=\"application/json\" id=\"run\">" + page_data(data) + "</script>\n<script>" + page::library_script +
          "</script>\n<script>" + page::own_script;
  return html + "</script></body></html>\n";
}

}  // namespace lf::record
