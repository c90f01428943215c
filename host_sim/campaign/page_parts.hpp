// The pieces that a campaign's page is put together from, each as HTML that needs nothing else. Each is empty where there is nothing to show.
#pragma once

#include <string>
#include <string_view>

#include "host_sim/campaign/comparison.hpp"
#include "host_sim/campaign/statistics/wilson.hpp"

namespace lf::campaign {

std::string_view page_style();

// A link to a run's report, or its words alone where the run has none.
std::string run_link(const RunSummary& run, const std::string& words);

// "192 of 200, 92 to 98 %": a share with its 95 % interval.
std::string share_text(std::size_t hits, std::size_t of, const Interval& interval);
// The same as a bar from 0 to 100 % with the interval on it.
std::string share_bar(std::size_t hits, std::size_t of, const Interval& interval);

// One row a cell: what it sets, success, false successes, and the median of each figure.
std::string cells_table(const Campaign& campaign);
// One row a figure of a cell: median, p95, worst, and the worst runs with links.
std::string figures_table(const Cell& cell);
std::string causes_table(const Campaign& campaign);
std::string runs_table(const Campaign& campaign);
std::string provenance_table(const Campaign& campaign);

// How a figure is spread over the runs: the share of the runs that are at most so large, one curve a cell, each run a point with a link to its report. Of one
// cell a histogram lies behind it, with median and p95.
std::string curve_svg(const Campaign& campaign, std::size_t figure);

std::string comparison_html(const Comparison& comparison);

}  // namespace lf::campaign
