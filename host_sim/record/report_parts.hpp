// The pieces that the report is put together from: text, drawings and the cloud, each as HTML that needs nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/record/report.hpp"

namespace lf::record {

// For element content and for attributes in double quotes. Bytes that are not UTF-8 become U+FFFD, control characters blanks.
std::string escape_html(std::string_view text);

// printf for one number; "–" (an en dash) when it is not finite.
std::string formatted(const char* format, double value);

// Phases as bars on a common time axis, one a row. Empty without phases.
std::string timeline_svg(const std::vector<PhaseRecord>& phases);

// The colour of each series of a chart, 0 to 5. A dashed series has that of the one before it: the target of what was reached.
std::vector<std::size_t> series_colours(const ReportChart& chart);

// Lines over time with a legend; the phases' boundaries as thin verticals, faults as flags. Series are drawn with at most 700 minima and maxima each.
std::string chart_svg(const ReportChart& chart, const RunResult& result);

// The place of the data's chart number `index`: its drawing, which the script replaces.
std::string chart_figure(const ReportData& data, std::size_t index);

// The frame of the 3D view: that of the fitted plane under the cloud's middle; without a cloud the true panel's. x right, y up, z toward the robot.
struct StageView {
  Pose view_from_base = Pose::Identity();
  double radius_m = 0.5;  // what of the panel is to be seen
  double yaw_rad = 0.5, pitch_rad = 0.35;
};
StageView stage_view(const ReportData& data);

// A picture of the cloud, and a canvas that takes its place where scripts run. Empty with neither points nor a robot.
std::string cloud_html(const ReportData& data);

// Slider, player and zoom; hidden until scripts run.
std::string controls_html();

// A shape's surface as triangles, counter-clockwise seen from outside. Curved surfaces are of `segments` flat pieces around.
struct Solid {
  std::vector<Vec3> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
Solid solid_of(const scene::Shape& shape, std::uint32_t segments = 20);

// What the page's scripts read, as JSON that may stand in a script element. Series over the same times share one list of times; one of more than
// `most_samples` is thinned to the lowest and highest of equal pieces, in their order. Six digits; what is not finite is null.
inline constexpr std::size_t most_samples = 6000;
std::string page_data(const ReportData& data);

// Of this page and of a campaign's.
std::string_view report_style();

}  // namespace lf::record
