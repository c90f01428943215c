#include <algorithm>
#include <cmath>
#include <vector>

#include "host_sim/campaign/figures.hpp"
#include "host_sim/campaign/page_parts.hpp"
#include "host_sim/campaign/statistics/percentile.hpp"
#include "host_sim/record/report_parts.hpp"

namespace lf::campaign {
namespace {

using record::escape_html;
using record::formatted;

// The drawing's own units; the page scales it.
constexpr double width = 540, height = 230, left = 44, right = 526, top = 8, bottom = 192;
constexpr std::size_t most_points = 400;  // of a curve: more cannot be told apart

std::string px(double value) { return formatted("%.1f", value); }

// 1, 2 or 5 times a power of ten, for some five steps over the range.
double tick_step(double range) {
  const double rough = range / 5, power = std::pow(10, std::floor(std::log10(rough)));
  const double ratio = rough / power;
  return power * (ratio <= 1 ? 1 : ratio <= 2 ? 2 : ratio <= 5 ? 5 : 10);
}

struct Scale {
  double low = 0, high = 1;
  double x(double value) const { return left + (value - low) / (high - low) * (right - left); }
};

double y(double share) { return bottom - share * (bottom - top); }

struct Point {
  double value = 0;
  const RunSummary* run = nullptr;
};

// Of the runs that have the figure, ascending.
std::vector<Point> points_of(const Cell& cell, std::size_t figure) {
  std::vector<Point> points;
  for (const RunSummary& run : cell.runs) {
    if (std::isfinite(run.figures[figure])) points.push_back({run.figures[figure], &run});
  }
  std::stable_sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.value < b.value; });
  return points;
}

Scale scale_of(const std::vector<std::vector<Point>>& curves) {
  Scale scale{INFINITY, -INFINITY};
  for (const std::vector<Point>& points : curves) {
    if (points.empty()) continue;
    scale.low = std::min(scale.low, points.front().value);
    scale.high = std::max(scale.high, points.back().value);
  }
  // A figure that is zero at best is drawn from zero, unless its range is a small part of it.
  if (scale.low > 0 && scale.low < scale.high / 2) scale.low = 0;
  // Where all runs are alike the axis has to have a length all the same: a hundredth of the value, or one about zero.
  const double size = std::max(std::abs(scale.low), std::abs(scale.high));
  const double margin = std::max(0.04 * (scale.high - scale.low), size > 0 ? 0.005 * size : 0.5);
  if (scale.low != 0) scale.low -= margin;
  scale.high += margin;
  return scale;
}

std::string line(double x1, double y1, double x2, double y2, const char* kind) {
  return std::string("<line class=\"") + kind + "\" x1=\"" + px(x1) + "\" y1=\"" + px(y1) + "\" x2=\"" + px(x2) + "\" y2=\"" + px(y2) +
         "\"/>";
}

std::string words(double x, double at_y, const char* kind, const std::string& text) {
  return std::string("<text class=\"") + kind + "\" x=\"" + px(x) + "\" y=\"" + px(at_y) + "\">" + escape_html(text) + "</text>";
}

std::string axes(const Scale& scale, const Figure& figure) {
  std::string svg;
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0})
    svg += line(left, y(share), right, y(share), "grid") + words(left - 6, y(share) + 4, "tick end", formatted("%.0f", 100 * share));
  const double step = tick_step(scale.high - scale.low);
  const int digits = std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 9);
  for (double k = std::ceil(scale.low / step - 1e-9); k * step <= scale.high; ++k) {
    svg += line(scale.x(k * step), top, scale.x(k * step), bottom, "grid");
    svg += words(scale.x(k * step), bottom + 16, "tick middle",
                 formatted(("%." + std::to_string(digits) + "f").c_str(), k == 0 ? 0 : k * step));
  }
  return svg + words(right, bottom + 34, "tick end", *figure.unit != 0 ? figure.unit : "share");
}

// About the square root of the runs' number in bars, the highest as high as the drawing.
std::string histogram(const std::vector<Point>& points, const Scale& scale) {
  constexpr std::size_t enough = 5, most = 30;
  const double low = points.front().value, high = points.back().value;
  if (points.size() < enough || high <= low) return "";
  const std::size_t bins = std::min(most, static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(points.size())))));
  std::vector<std::size_t> counts(bins, 0);
  const auto of_bin = [&](double value) {
    return std::min(bins - 1, static_cast<std::size_t>((value - low) / (high - low) * static_cast<double>(bins)));
  };
  for (const Point& point : points) ++counts[of_bin(point.value)];
  const double highest = static_cast<double>(*std::max_element(counts.begin(), counts.end()));
  std::string svg;
  for (std::size_t i = 0; i < bins; ++i) {
    if (counts[i] == 0) continue;
    const double from = low + (high - low) * static_cast<double>(i) / static_cast<double>(bins),
                 step = (high - low) / static_cast<double>(bins);
    const double share = static_cast<double>(counts[i]) / highest;
    svg += "<rect class=\"histogram\" x=\"" + px(scale.x(from)) + "\" y=\"" + px(y(share)) + "\" width=\"" +
           px(scale.x(from + step) - scale.x(from)) + "\" height=\"" + px(bottom - y(share)) + "\"><title>" + formatted("%.3g", from) +
           " to " + formatted("%.3g", from + step) + ": " + std::to_string(counts[i]) + (counts[i] == 1 ? " run" : " runs") +
           "</title></rect>";
  }
  return svg;
}

// Median and p95, where p95 is what 95 % of the runs are no worse than.
std::string ranks(const std::vector<Point>& points, const Scale& scale, const Figure& figure) {
  const double sign = figure.good == Figure::Good::more ? -1 : 1;
  std::vector<double> values;
  values.reserve(points.size());
  for (const Point& point : points) values.push_back(sign * point.value);
  const double median = sign * nearest_rank(values, 0.5), p95 = sign * nearest_rank(values, 0.95);
  const auto mark = [&](double value, const char* name) {
    const bool at_end = scale.x(value) > (left + right) / 2;
    return line(scale.x(value), top, scale.x(value), bottom, "rank") +
           words(scale.x(value) + (at_end ? -4 : 4), bottom - 6, at_end ? "tick end" : "tick", name);
  };
  return mark(median, "median") + (points.size() >= 20 ? mark(p95, "95 %") : "");
}

std::string curve(const std::vector<Point>& points, const Scale& scale, const Figure& figure, const std::string& label,
                  std::size_t colour) {
  const double n = static_cast<double>(points.size());
  std::string path = "M" + px(scale.x(points.front().value)) + " " + px(y(0)), dots;
  // The extremes are always among those shown.
  const std::size_t every = (points.size() + most_points - 1) / most_points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % every != 0 && i + 5 < points.size() && i > 5) continue;
    const double at = scale.x(points[i].value), share = static_cast<double>(i + 1) / n;
    path += "H" + px(at) + "V" + px(y(share));
    const RunSummary& run = *points[i].run;
    const std::string circle = "<circle class=\"point p" + std::to_string(colour % 6) + (run.success ? "" : " failed") + "\" cx=\"" +
                               px(at) + "\" cy=\"" + px(y(share)) + "\" r=\"" + (points.size() > 60 ? "2" : "3.5") + "\"><title>" +
                               escape_html((label.empty() ? "" : label + ", ") + "seed " + std::to_string(run.seed)) + ": " +
                               formatted("%.4g", points[i].value) + " " + escape_html(figure.unit) + "</title></circle>";
    dots += run.has_report ? "<a href=\"" + escape_html(run.folder) + "/report.html\">" + circle + "</a>" : circle;
  }
  return "<path class=\"curve s" + std::to_string(colour % 6) + "\" d=\"" + path + "\"/>" + dots;
}

}  // namespace

std::string curve_svg(const Campaign& campaign, std::size_t index) {
  const Figure& figure = figures()[index];
  std::vector<std::vector<Point>> curves;
  std::size_t runs = 0;
  for (const Cell& cell : campaign.cells) {
    curves.push_back(points_of(cell, index));
    runs += curves.back().size();
  }
  if (runs == 0) return "";
  const Scale scale = scale_of(curves);
  std::string html = "<figure><figcaption><b>" + escape_html(figure.title) + "</b> <span class=\"unit\">" + escape_html(figure.unit) +
                     "</span></figcaption>";
  html += "<svg class=\"drawing\" viewBox=\"0 0 " + px(width) + " " + px(height) + "\" role=\"img\" aria-label=\"" +
          escape_html(figure.title) + ": share of the runs that are at most so large\">" + axes(scale, figure);
  if (curves.size() == 1) html += histogram(curves[0], scale) + ranks(curves[0], scale, figure);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    if (!curves[i].empty()) html += curve(curves[i], scale, figure, label_of(campaign.cells[i].choice), i);
  }
  return html + "</svg></figure>";
}

}  // namespace lf::campaign
