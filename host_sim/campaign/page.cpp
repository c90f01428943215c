#include "host_sim/campaign/page.hpp"

#include "host_sim/campaign/figures.hpp"
#include "host_sim/campaign/page_parts.hpp"
#include "host_sim/campaign/tally.hpp"
#include "host_sim/record/report_parts.hpp"

namespace lf::campaign {
namespace {

using record::escape_html;
using record::formatted;

std::string section(const std::string& title, const std::string& content) {
  return content.empty() ? "" : "<section><h2>" + escape_html(title) + "</h2>" + content + "</section>\n";
}

std::string tile(const std::string& value, const std::string& name) {
  return "<div class=\"tile\"><b>" + escape_html(value) + "</b><span>" + escape_html(name) + "</span></div>";
}

std::string percent(const Interval& interval) {
  return formatted("%.1f", 100 * interval.low) + " to " + formatted("%.1f %%", 100 * interval.high);
}

std::string header(const Campaign& campaign) {
  const Tally total = total_of(campaign);
  const bool whole = all_succeeded(campaign);
  const std::string verdict = total.not_flown > 0 ? "not finished" : whole ? "all succeeded" : "some failed";
  std::string html = whole ? "<header class=\"done\">" : "<header class=\"failed\">";
  html += "<h1><span class=\"verdict\">" + verdict + "</span>" + escape_html(campaign.scenario) + ", seeds " + escape_html(campaign.seeds) +
          "</h1>";
  if (total.not_flown > 0)
    html += "<p class=\"reason\">The campaign was interrupted: " + std::to_string(total.not_flown) + " runs were not flown.</p>";
  html += "<div class=\"soft\">Lanternfish " + escape_html(campaign.version) + ". The same campaign again:</div><pre>" +
          escape_html(campaign.command) + "</pre>";
  html += "<div class=\"tiles\">" + tile(std::to_string(total.successes) + " of " + std::to_string(total.runs), "runs succeeded") +
          tile(percent(total.success), "95 % interval of success") + tile(std::to_string(total.false_successes), "false successes") +
          tile(percent(total.false_success), "95 % interval of false success") +
          tile(std::to_string(total.calibrations_doubted), "with a doubtful calibration");
  if (campaign.cells.size() > 1) html += tile(std::to_string(campaign.cells.size()), "cells of the grid");
  return html + "</div></header>\n";
}

std::string legend(const Campaign& campaign) {
  if (campaign.cells.size() < 2) return "";
  std::string html = "<div class=\"legend\">";
  for (std::size_t i = 0; i < campaign.cells.size(); ++i) {
    html += "<span><svg width=\"26\" height=\"10\" aria-hidden=\"true\"><line class=\"curve s" + std::to_string(i % 6) +
            "\" x1=\"1\" y1=\"5\" x2=\"25\" y2=\"5\"/></svg>" + escape_html(label_of(campaign.cells[i].choice)) + "</span>";
  }
  return html + "</div>";
}

std::string curves(const Campaign& campaign) {
  std::string html;
  for (std::size_t i = 0; i < figures().size(); ++i) html += curve_svg(campaign, i);
  if (html.empty()) return "";
  const std::string bars = html.find("class=\"histogram\"") != std::string::npos ? " The bars behind are the histogram." : "";
  return "<p class=\"none\">Share of the runs, in %, that are at most so large; each point is a run and leads to its report, failed runs "
         "are red." +
         bars + "</p>" + legend(campaign) + "<div class=\"curves\">" + html + "</div>";
}

std::string all_figures(const Campaign& campaign) {
  if (campaign.keys.empty()) return figures_table(campaign.cells[0]);
  constexpr std::size_t few = 4;
  std::string html;
  for (const Cell& cell : campaign.cells) {
    const std::string table = figures_table(cell);
    if (table.empty()) continue;
    html += "<details" + std::string(campaign.cells.size() <= few ? " open" : "") + "><summary>" + escape_html(label_of(cell.choice)) +
            "</summary>" + table + "</details>";
  }
  return html;
}

}  // namespace

std::string page_html(const Campaign& campaign, const Comparison* comparison) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\">"
      "<meta name=\"color-scheme\" content=\"light dark\"><title>Lanternfish: " +
      escape_html(campaign.scenario) + ", seeds " + escape_html(campaign.seeds) + "</title><style>" + std::string(record::report_style()) +
      std::string(page_style()) + "</style></head>\n<body><main>\n";
  html += header(campaign);
  if (comparison != nullptr) html += section("Compared with an earlier campaign", comparison_html(*comparison));
  html += section("The grid", cells_table(campaign));
  html += section("Failures by cause", causes_table(campaign));
  html += section("Figures, and the worst runs of each", all_figures(campaign));
  html += section("Distributions", curves(campaign));
  html += section("All runs", runs_table(campaign));
  html += section("Where this comes from", provenance_table(campaign));
  html += "<footer>Written by lanternfish " + escape_html(campaign.version) +
          "; the same figures stand in campaign.json, campaign.csv and runs.csv.</footer>\n";
  return html + "</main></body></html>\n";
}

}  // namespace lf::campaign
