#include <algorithm>
#include <cmath>
#include <vector>

#include "host_sim/record/report_parts.hpp"

namespace lf::record {
namespace {

constexpr double width = 1120;  // of every drawing, in its own units; the page scales it
constexpr double right_margin = 16;

std::string px(double value) { return formatted("%.1f", value); }

std::string line(double x1, double y1, double x2, double y2, const char* kind) {
  return "<line class=\"" + std::string(kind) + "\" x1=\"" + px(x1) + "\" y1=\"" + px(y1) + "\" x2=\"" + px(x2) + "\" y2=\"" + px(y2) +
         "\"/>";
}

std::string text(double x, double y, const char* kind, const std::string& content) {
  return "<text class=\"" + std::string(kind) + "\" x=\"" + px(x) + "\" y=\"" + px(y) + "\">" + escape_html(content) + "</text>";
}

// 1, 2 or 5 times a power of ten, for about `count` steps over the range.
double tick_step(double range, int count) {
  const double rough = range / count;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  const double ratio = rough / power;
  return power * (ratio <= 1 ? 1 : ratio <= 2 ? 2 : ratio <= 5 ? 5 : 10);
}

struct Axis {
  double low = 0, high = 1;  // values
  double from = 0, to = 1;   // drawing
  int ticks = 5;

  double at(double value) const { return from + (value - low) / (high - low) * (to - from); }
  double step() const { return tick_step(high - low, ticks); }
  std::vector<double> marks() const {
    std::vector<double> values;
    const double s = step();
    for (double k = std::ceil(low / s - 1e-9); k * s <= high + 1e-9 * s; ++k) values.push_back(k * s);
    return values;
  }
  std::string label(double value) const {
    const int digits = std::max(0, static_cast<int>(-std::floor(std::log10(step()) + 1e-9)));
    return formatted(("%." + std::to_string(std::min(digits, 9)) + "f").c_str(), value == 0 ? 0 : value);
  }
};

std::string time_marks(const Axis& time, double top, double bottom) {
  std::string svg;
  for (const double t : time.marks()) {
    svg += line(time.at(t), top, time.at(t), bottom, "grid") + text(time.at(t), bottom + 16, "tick middle", time.label(t));
  }
  return svg + text(width - right_margin, bottom + 32, "tick end", "simulated time, s");
}

const char* kind_of(const std::string& outcome) {
  if (outcome == "done") return "good";
  if (outcome == "failed" || outcome == "aborted") return "bad";
  return "fair";
}

bool drawable(const PhaseRecord& phase) {
  return std::isfinite(phase.start_s) && std::isfinite(phase.end_s) && phase.end_s >= phase.start_s;
}

struct Sample {
  double t = 0, value = 0;
};

// The first and last, lowest and highest of each of `buckets` spans of time, so that no spike is lost; gaps stay gaps.
std::vector<Sample> thinned(const ReportSeries& series, double low, double high) {
  constexpr double buckets = 350;
  const std::size_t count = std::min(series.t_s.size(), series.value.size());
  std::vector<Sample> kept;
  std::size_t i = 0;
  while (i < count) {
    const double bucket = std::floor((series.t_s[i] - low) / (high - low) * buckets);
    std::size_t lowest = i, highest = i, last = i;
    const bool gap = !std::isfinite(series.value[i]);
    for (; i < count && !std::isfinite(series.value[i]) == gap && std::floor((series.t_s[i] - low) / (high - low) * buckets) <= bucket;
         ++i) {
      if (series.value[i] < series.value[lowest]) lowest = i;
      if (series.value[i] > series.value[highest]) highest = i;
      last = i;
    }
    std::size_t picks[] = {lowest, highest};
    if (highest < lowest) std::swap(picks[0], picks[1]);
    for (const std::size_t pick : picks) {
      if (gap || kept.empty() || kept.back().t != series.t_s[pick]) kept.push_back({series.t_s[pick], series.value[pick]});
    }
    if (!gap && last != picks[1] && i >= count) kept.push_back({series.t_s[last], series.value[last]});
  }
  return kept;
}

std::vector<std::string> kinds_of(const ReportChart& chart) {
  std::vector<std::string> kinds;
  const std::vector<std::size_t> colours = series_colours(chart);
  for (std::size_t i = 0; i < colours.size(); ++i)
    kinds.push_back("series s" + std::to_string(colours[i]) + (chart.series[i].dashed ? " dashed" : ""));
  return kinds;
}

// A line with a flag; a fault that came again is a bar to its last time.
std::string fault_flags(const std::vector<FaultRecord>& faults, const Axis& time, double top, double bottom) {
  std::string svg;
  for (const FaultRecord& fault : faults) {
    if (!(fault.t_s >= time.low && fault.t_s <= time.high)) continue;
    const double from = time.at(fault.t_s), to = time.at(std::clamp(fault.last_s, fault.t_s, time.high));
    svg += "<g class=\"fault\"><title>" + formatted("%.3f s: ", fault.t_s) + escape_html(fault.text) +
           (fault.reaction.empty() ? "" : ": " + escape_html(fault.reaction)) + "</title>" + line(from, top, from, bottom, "flag") +
           "<rect class=\"flag\" x=\"" + px(from) + "\" y=\"" + px(top) + "\" width=\"" + px(std::max(7.0, to - from)) +
           "\" height=\"5\"/></g>";
  }
  return svg;
}

std::string polyline(const ReportSeries& series, const std::string& kind, const Axis& time, const Axis& value) {
  std::string path;
  bool pen_down = false;
  for (const Sample& sample : thinned(series, time.low, time.high)) {
    if (!std::isfinite(sample.value) || !std::isfinite(sample.t)) {
      pen_down = false;
      continue;
    }
    path += (pen_down ? "L" : "M") + px(time.at(sample.t)) + " " + px(value.at(sample.value));
    pen_down = true;
  }
  return "<path class=\"" + kind + "\" d=\"" + path + "\"/>";
}

bool has_samples(const ReportSeries& series) {
  return std::any_of(series.value.begin(), series.value.end(), [](double value) { return std::isfinite(value); });
}

// In the colour of the series, with its name as a tooltip.
std::string limit_lines(const ReportSeries& series, std::size_t colour, const Axis& time, const Axis& value) {
  std::string svg;
  for (const double limit : {series.limits.low, series.limits.high}) {
    if (!std::isfinite(limit) || !has_samples(series)) continue;
    svg += "<g><title>" + escape_html(series.name) + ": " + formatted("limit %g", limit) + "</title>" +
           line(time.from, value.at(limit), time.to, value.at(limit), ("limit s" + std::to_string(colour)).c_str()) + "</g>";
  }
  return svg;
}

std::string limits_key(const ReportChart& chart) {
  const bool any = std::any_of(chart.series.begin(), chart.series.end(), [](const ReportSeries& series) {
    return has_samples(series) && (std::isfinite(series.limits.low) || std::isfinite(series.limits.high));
  });
  if (!any) return "";
  return "<span><svg width=\"26\" height=\"10\" aria-hidden=\"true\"><line class=\"limit s0\" x1=\"1\" y1=\"5\" x2=\"25\" "
         "y2=\"5\"/></svg>limits, each in its line's colour</span>";
}

std::string legend(const ReportChart& chart) {
  std::string html = "<div class=\"legend\">";
  const std::vector<std::string> kinds = kinds_of(chart);
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    html += "<span><svg width=\"26\" height=\"10\" aria-hidden=\"true\"><line class=\"" + kinds[i] +
            "\" x1=\"1\" y1=\"5\" x2=\"25\" y2=\"5\"/></svg>" + escape_html(chart.series[i].name) + "</span>";
  }
  return html + limits_key(chart) + "</div>";
}

// The range of all finite samples and of their limits; `found` is false when there is no sample.
void ranges(const ReportChart& chart, Axis& time, Axis& value, bool& found) {
  found = false;
  for (const ReportSeries& series : chart.series) {
    for (std::size_t i = 0; i < std::min(series.t_s.size(), series.value.size()); ++i) {
      const double t = series.t_s[i], v = series.value[i];
      if (!std::isfinite(t) || !std::isfinite(v)) continue;
      time.low = found ? std::min(time.low, t) : t;
      time.high = found ? std::max(time.high, t) : t;
      value.low = found ? std::min(value.low, v) : v;
      value.high = found ? std::max(value.high, v) : v;
      found = true;
    }
    if (!has_samples(series)) continue;
    if (std::isfinite(series.limits.low)) value.low = std::min(value.low, series.limits.low);
    if (std::isfinite(series.limits.high)) value.high = std::max(value.high, series.limits.high);
  }
  if (time.high <= time.low) time.high = time.low + 1;
  const double margin = std::max(0.05 * (value.high - value.low), 1e-3 * std::max(std::abs(value.low), std::abs(value.high)));
  value.low -= value.low == 0 ? 0 : margin;  // a quantity that starts at zero keeps zero as its floor
  value.high += margin > 0 ? margin : 1;
}

}  // namespace

std::vector<std::size_t> series_colours(const ReportChart& chart) {
  std::vector<std::size_t> colours;
  std::size_t solid = 0;
  for (const ReportSeries& series : chart.series) {
    const std::size_t colour = series.dashed && solid > 0 ? solid - 1 : solid;
    if (colour == solid) ++solid;
    colours.push_back(colour % 6);
  }
  return colours;
}

namespace {

// "20.5 s, failed", behind a phase's bar.
std::string note_of(const PhaseRecord& phase) {
  const std::string seconds = formatted("%.1f s", phase.end_s - phase.start_s);
  return phase.outcome == "done" ? seconds : seconds + ", " + phase.outcome;
}

constexpr double letter = 7.7;  // width of a digit at 12 px in DejaVu Sans, the widest of the page's fonts

}  // namespace

std::string timeline_svg(const std::vector<PhaseRecord>& phases) {
  constexpr double left = 170, row = 24, top = 6, note_gap = 6;
  std::vector<PhaseRecord> drawn;
  std::copy_if(phases.begin(), phases.end(), std::back_inserter(drawn), drawable);
  if (drawn.empty()) return "";
  std::size_t longest = 0;
  for (const PhaseRecord& phase : drawn) longest = std::max(longest, note_of(phase).size());
  const double right = std::max(width / 2, width - right_margin - note_gap - letter * static_cast<double>(longest));
  Axis time{drawn[0].start_s, drawn[0].end_s, left, right, 10};
  for (const PhaseRecord& phase : drawn) {
    time.low = std::min(time.low, phase.start_s);
    time.high = std::max(time.high, phase.end_s);
  }
  if (time.high <= time.low) time.high = time.low + 1;
  const double bottom = top + row * static_cast<double>(drawn.size());
  std::string svg =
      "<svg class=\"drawing\" viewBox=\"0 0 " + px(width) + " " + px(bottom + 38) + "\" role=\"img\" aria-label=\"Phases over time\">";
  svg += time_marks(time, top, bottom);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const PhaseRecord& phase = drawn[i];
    const double y = top + row * static_cast<double>(i);
    const double from = time.at(phase.start_s), length = std::max(2.0, time.at(phase.end_s) - from);
    svg += text(left - 10, y + 16, "label end", phase.name);
    svg += "<rect class=\"bar " + std::string(kind_of(phase.outcome)) + "\" x=\"" + px(from) + "\" y=\"" + px(y + 4) + "\" width=\"" +
           px(length) + "\" height=\"16\" rx=\"3\"><title>" + escape_html(phase.name + ": " + phase.outcome) + ", " +
           formatted("%.2f", phase.start_s) + " to " + formatted("%.2f s", phase.end_s) + "</title></rect>";
    svg += text(from + length + note_gap, y + 16, "tick", note_of(phase));
  }
  return svg + "</svg>";
}

std::string chart_svg(const ReportChart& chart, const RunResult& result) {
  constexpr double left = 64, top = 10, bottom = 210;
  Axis time{0, 1, left, width - right_margin, 10}, value{0, 1, bottom, top, 5};
  bool found = false;
  ranges(chart, time, value, found);
  std::string html = "<div class=\"still\">" + legend(chart);
  if (!found) return html + "<p class=\"none\">nothing was recorded</p></div>";
  html += "<svg class=\"drawing\" viewBox=\"0 0 " + px(width) + " " + px(bottom + 38) + "\" role=\"img\" aria-label=\"" +
          escape_html(chart.title) + " over time\">" + time_marks(time, top, bottom);
  for (const double v : value.marks()) {
    html += line(left, value.at(v), width - right_margin, value.at(v), v == 0 ? "zero" : "grid") +
            text(left - 8, value.at(v) + 4, "tick end", value.label(v));
  }
  for (const PhaseRecord& phase : result.phases) {
    if (!drawable(phase) || phase.start_s <= time.low || phase.start_s >= time.high) continue;
    html += line(time.at(phase.start_s), top, time.at(phase.start_s), bottom, "phase");
  }
  const std::vector<std::string> kinds = kinds_of(chart);
  const std::vector<std::size_t> colours = series_colours(chart);
  for (std::size_t i = 0; i < chart.series.size(); ++i) html += limit_lines(chart.series[i], colours[i], time, value);
  for (std::size_t i = 0; i < chart.series.size(); ++i) html += polyline(chart.series[i], kinds[i], time, value);
  return html + fault_flags(result.faults, time, top, bottom) + "</svg></div>";
}

std::string chart_figure(const ReportData& data, std::size_t index) {
  const ReportChart& chart = data.charts[index];
  return "<figure class=\"chart\" data-chart=\"" + std::to_string(index) + "\"><figcaption><b>" + escape_html(chart.title) +
         "</b> <span class=\"unit\">" + escape_html(chart.unit) + "</span></figcaption>" + chart_svg(chart, data.result) + "</figure>";
}

}  // namespace lf::record
