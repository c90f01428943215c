// The pieces that the report is put together from: text, drawings and the cloud, each as HTML that needs nothing else.
#pragma once

#include <string>
#include <string_view>

#include "host_sim/record/report.hpp"

namespace lf::record {

// For element content and for attributes in double quotes. Bytes that are not UTF-8 become U+FFFD, control characters blanks.
std::string escape_html(std::string_view text);

// printf for one number; "–" (an en dash) when it is not finite.
std::string formatted(const char* format, double value);

// Phases as bars on a common time axis, one a row. Empty without phases.
std::string timeline_svg(const std::vector<PhaseRecord>& phases);

// Lines over time with a legend; the phases' boundaries as thin verticals. Series are drawn with at most 700 minima and maxima each.
std::string chart_svg(const ReportChart& chart, const std::vector<PhaseRecord>& phases);

// A picture of the cloud, and a canvas that takes its place where scripts run. Empty without points.
std::string cloud_view(const std::vector<CloudPoint>& cloud, const PlaneFit& fit);

std::string_view report_style();
std::string_view report_script();

}  // namespace lf::record
