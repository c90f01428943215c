#include <algorithm>
#include <cmath>

#include "host_sim/campaign/causes.hpp"
#include "host_sim/campaign/figures.hpp"
#include "host_sim/campaign/page_parts.hpp"
#include "host_sim/campaign/tally.hpp"
#include "host_sim/record/report_parts.hpp"

namespace lf::campaign {
namespace {

using record::escape_html;
using record::formatted;

std::string th(const std::string& text, const char* kind = "") {
  return std::string("<th") + (*kind != 0 ? std::string(" class=\"") + kind + "\"" : "") + ">" + escape_html(text) + "</th>";
}

std::string td(const std::string& html, const char* kind = "") {
  return std::string("<td") + (*kind != 0 ? std::string(" class=\"") + kind + "\"" : "") + ">" + html + "</td>";
}

std::string value_text(double value, const Figure& figure) {
  if (!std::isfinite(value)) return "–";
  return formatted("%.3g", value) + (*figure.unit != 0 ? " " + escape_html(figure.unit) : "");
}

std::string run_name(const Campaign& campaign, std::size_t cell, std::size_t run) {
  const Cell& of = campaign.cells[cell];
  const std::string seed = "seed " + std::to_string(of.runs[run].seed);
  return of.choice.empty() ? seed : label_of(of.choice) + ", " + seed;
}

// As many as a reader looks at; the rest stand in runs.csv.
constexpr std::size_t most_links = 60, most_rows = 2000;

std::string row(const std::string& name, const std::string& html, const char* kind = "") {
  return "<tr>" + td(escape_html(name)) + td(html, kind) + "</tr>";
}

}  // namespace

std::string run_link(const RunSummary& run, const std::string& words) {
  if (!run.has_report) return escape_html(words);
  // The folders' names are made of letters that an address takes as they are, but for '+', ',' and '=' which it takes in a path, too.
  return "<a href=\"" + escape_html(run.folder) + "/report.html\">" + escape_html(words) + "</a>";
}

std::string share_text(std::size_t hits, std::size_t of, const Interval& interval) {
  const std::string counts = std::to_string(hits) + " of " + std::to_string(of);
  return of == 0 ? counts : counts + ", " + formatted("%.1f", 100 * interval.low) + " to " + formatted("%.1f %%", 100 * interval.high);
}

std::string share_bar(std::size_t hits, std::size_t of, const Interval& interval) {
  if (of == 0) return "";
  constexpr double width = 160;
  const double share = static_cast<double>(hits) / static_cast<double>(of);
  const auto px = [](double value) { return formatted("%.1f", value); };
  return std::string("<svg class=\"share") + (hits == of ? "" : " few") + "\" viewBox=\"0 0 160 14\" role=\"img\" aria-label=\"" +
         share_text(hits, of, interval) + "\"><rect class=\"all\" width=\"160\" height=\"14\" rx=\"3\"/><rect class=\"hits\" width=\"" +
         px(width * share) + "\" height=\"14\" rx=\"3\"/><path class=\"interval\" d=\"M" + px(width * interval.low) + " 3v8m0-4H" +
         px(width * interval.high) + "m0-4v8\"/></svg>";
}

std::string cells_table(const Campaign& campaign) {
  if (campaign.keys.empty()) return "";
  std::vector<std::size_t> shown;  // figures that any cell has, but for those of the machine
  std::vector<Tally> tallies;
  tallies.reserve(campaign.cells.size());
  for (const Cell& cell : campaign.cells) tallies.push_back(tally_of(cell));
  for (std::size_t i = 0; i < figures().size(); ++i) {
    const auto has = [i](const Tally& tally) {
      return std::any_of(tally.spreads.begin(), tally.spreads.end(), [i](const Spread& spread) { return spread.figure == i; });
    };
    if (!figures()[i].of_the_machine && std::any_of(tallies.begin(), tallies.end(), has)) shown.push_back(i);
  }
  std::string html = "<div class=\"wide\"><table><tr>";
  for (const std::string& key : campaign.keys) html += th(key);
  html += th("succeeded, 95 % interval") + th("") + th("false successes");
  for (const std::size_t i : shown) html += th(std::string(figures()[i].title) + ", median", "n");
  html += "</tr>";
  for (std::size_t c = 0; c < campaign.cells.size(); ++c) {
    const Tally& tally = tallies[c];
    html += "<tr>";
    for (const auto& [key, value] : campaign.cells[c].choice) html += td(escape_html(value));
    const std::string missing = tally.not_flown > 0 ? ", " + std::to_string(tally.not_flown) + " not flown" : "";
    html += td(share_text(tally.successes, tally.runs, tally.success) + missing, "whole") +
            td(share_bar(tally.successes, tally.runs, tally.success)) +
            td(share_text(tally.false_successes, tally.runs, tally.false_success), "whole");
    for (const std::size_t i : shown) {
      const auto found = std::find_if(tally.spreads.begin(), tally.spreads.end(), [i](const Spread& spread) { return spread.figure == i; });
      html += td(found == tally.spreads.end() ? "–" : value_text(found->median, figures()[i]), "n");
    }
    html += "</tr>";
  }
  return html + "</table></div>";
}

std::string figures_table(const Cell& cell) {
  const Tally tally = tally_of(cell);
  if (tally.spreads.empty()) return "";
  std::string html = "<div class=\"wide\"><table><tr>" + th("") + th("runs", "n") + th("median", "n") + th("95 %", "n") + th("worst", "n") +
                     th("worst runs") + "</tr>";
  for (const Spread& spread : tally.spreads) {
    const Figure& figure = figures()[spread.figure];
    std::string worst;
    for (const std::size_t i : spread.worst_runs) {
      worst += (worst.empty() ? "" : ", ") + run_link(cell.runs[i], "seed " + std::to_string(cell.runs[i].seed)) + " (" +
               formatted("%.3g", cell.runs[i].figures[spread.figure]) + ")";
    }
    html += "<tr>" + td(escape_html(figure.title)) + td(std::to_string(spread.runs), "n") + td(value_text(spread.median, figure), "n") +
            td(value_text(spread.p95, figure), "n") + td(value_text(spread.worst, figure), "n") + td(worst) + "</tr>";
  }
  return html + "</table></div>";
}

std::string causes_table(const Campaign& campaign) {
  const std::vector<Cause> causes = causes_of(campaign);
  if (causes.empty()) return "";
  std::string html = "<table><tr>" + th("runs", "n") + th("in") + th("cause") + th("which") + "</tr>";
  for (const Cause& cause : causes) {
    std::string links;
    for (std::size_t i = 0; i < std::min(cause.runs.size(), most_links); ++i) {
      const auto [c, r] = cause.runs[i];
      links += (i == 0 ? "" : ", ") + run_link(campaign.cells[c].runs[r], run_name(campaign, c, r));
    }
    if (cause.runs.size() > most_links) links += ", and " + std::to_string(cause.runs.size() - most_links) + " more";
    const std::string lie = cause.false_success ? "<span class=\"mark bad\">false success</span> " : "";
    const std::string example =
        cause.example == cause.cause ? "" : "<br><span class=\"soft\">such as: " + escape_html(cause.example) + "</span>";
    html += "<tr>" + td(std::to_string(cause.runs.size()), "n") + td(escape_html(cause.phase)) +
            td(lie + escape_html(cause.cause) + example) + td(links) + "</tr>";
  }
  return html + "</table>";
}

std::string runs_table(const Campaign& campaign) {
  std::size_t all = 0;
  std::string rows;
  for (std::size_t c = 0; c < campaign.cells.size(); ++c) {
    const Cell& cell = campaign.cells[c];
    for (std::size_t r = 0; r < cell.runs.size(); ++r) {
      if (++all > most_rows) continue;
      const RunSummary& run = cell.runs[r];
      rows += "<tr>" + td(run_link(run, run_name(campaign, c, r)));
      for (std::size_t i = 0; i < figures().size(); ++i) {
        if (!figures()[i].of_the_machine) rows += td(formatted("%.3g", run.figures[i]), "n");
      }
      rows += td("<span class=\"mark " + std::string(run.success ? "good" : "bad") + "\">" + escape_html(verdict_of(run)) + "</span>") +
              "</tr>";
    }
    for (const std::uint64_t seed : cell.not_flown) {
      if (++all > most_rows) continue;
      const std::string name = (cell.choice.empty() ? "" : label_of(cell.choice) + ", ") + "seed " + std::to_string(seed);
      const auto columns = std::count_if(figures().begin(), figures().end(), [](const Figure& figure) { return !figure.of_the_machine; });
      rows += "<tr>" + td(escape_html(name)) + "<td colspan=\"" + std::to_string(columns) + "\"></td>" + td("not flown", "soft") + "</tr>";
    }
  }
  if (all == 0) return "";
  std::string html = "<details" + std::string(all <= 20 ? " open" : "") + "><summary>" + std::to_string(all) +
                     (all == 1 ? " run" : " runs") + "</summary><div class=\"wide\"><table><tr>" + th("");
  for (const Figure& figure : figures()) {
    if (!figure.of_the_machine) html += th(std::string(figure.title) + (*figure.unit != 0 ? std::string(", ") + figure.unit : ""), "n");
  }
  html += th("came to") + "</tr>" + rows + "</table></div>";
  if (all > most_rows) html += "<p class=\"none\">and " + std::to_string(all - most_rows) + " more: runs.csv</p>";
  return html + "</details>";
}

std::string provenance_table(const Campaign& campaign) {
  std::string html = "<table>" + row("command", escape_html(campaign.command), "code") + row("scenario", escape_html(campaign.scenario)) +
                     row("seeds", escape_html(campaign.seeds));
  std::string sets;
  for (const std::string& set : campaign.set) sets += (sets.empty() ? "" : "<br>") + escape_html(set);
  if (!sets.empty()) html += row("--set", sets, "code");
  for (const Sitting& sitting : campaign.sittings) {
    html += row(campaign.sittings.size() == 1 ? "flown" : "flown, in several sittings",
                escape_html(sitting.begun + " to " + sitting.ended) + ", " + std::to_string(sitting.flown) +
                    (sitting.flown == 1 ? " run" : " runs"));
  }
  html += row("version", escape_html(campaign.version + ", " + campaign.revision));
  for (const Cell& cell : campaign.cells) {
    html += row(cell.choice.empty() ? "experiment" : label_of(cell.choice), record::hash_of(cell.experiment), "code");
  }
  html += "</table><details><summary>what the experiment is made of</summary><table>";
  for (const auto& [name, value] : campaign.cells[0].experiment) {
    html += row(name, name == "scenario" ? "<pre>" + escape_html(value) + "</pre>" : escape_html(value), "code");
  }
  return html + "</table></details>";
}

}  // namespace lf::campaign
