#include "host_sim/campaign/page_parts.hpp"
#include "host_sim/record/report_parts.hpp"

namespace lf::campaign {
namespace {

using record::escape_html;
using record::formatted;
using Verdict = Change::Verdict;

std::string mark(Verdict verdict) {
  if (verdict == Verdict::same) return "";
  return verdict == Verdict::worse ? "<span class=\"mark bad\">worse</span>" : "<span class=\"mark good\">better</span>";
}

std::string value(const Change& change, double number, const std::string& counts) {
  return counts.empty() ? formatted("%.4g", number) + " " + escape_html(change.unit) : escape_html(counts);
}

std::string change_row(const Change& change, bool has_cells) {
  std::string html = "<tr>";
  if (has_cells) html += "<td>" + escape_html(change.cell) + "</td>";
  html += "<td>" + escape_html(change.figure + (change.before_counts.empty() ? ", " + change.of : "")) + "</td><td class=\"n\">" +
          value(change, change.before, change.before_counts) + "</td><td class=\"n\">" + value(change, change.after, change.after_counts) +
          "</td>";
  if (change.test.empty()) return html + "<td class=\"soft\" colspan=\"3\">depends on the machine, not tested</td><td></td></tr>";
  return html + "<td>" + escape_html(change.test) + ", n = " + std::to_string(change.n) + "</td><td class=\"n\">" +
         formatted("%.2g", change.p) + "</td><td class=\"n\">" + formatted("%.2g", change.p_of_all) + "</td><td>" + mark(change.verdict) +
         "</td></tr>";
}

}  // namespace

std::string comparison_html(const Comparison& comparison) {
  std::string html = "<p>Against <b>" + escape_html(comparison.with) + "</b>, over " + std::to_string(comparison.pairs) + " common seeds: ";
  const char* verdict = comparison.worse()          ? "<span class=\"mark bad\">worse</span>"
                        : comparison.better()       ? "<span class=\"mark good\">better</span>"
                        : !comparison.doubt.empty() ? "<span class=\"doubt\">doubtful</span>"
                        : comparison.identical      ? "identical, bit by bit"
                                                    : "nothing changed beyond chance";
  html += std::string(verdict) + ".</p>";
  if (!comparison.doubt.empty()) html += "<p class=\"doubt\">" + escape_html(comparison.doubt) + "</p>";
  if (!comparison.notes.empty() || !comparison.turns.empty()) {
    html += "<ul>";
    for (const std::string& note : comparison.notes) html += "<li>" + escape_html(note) + "</li>";
    for (const Turn& turn : comparison.turns) {
      html += "<li><span class=\"mark " + std::string(turn.success ? "good" : "bad") + "\">" +
              escape_html((turn.cell.empty() ? "" : turn.cell + ", ") + "seed " + std::to_string(turn.seed)) + "</span>: was " +
              escape_html(turn.before) + "; is " + escape_html(turn.after) + "</li>";
    }
    html += "</ul>";
  }
  const bool has_cells = !comparison.changes.empty() && !comparison.changes[0].cell.empty();
  const std::string head =
      std::string("<div class=\"wide\"><table><tr>") + (has_cells ? "<th></th>" : "") +
      "<th></th><th class=\"n\">before</th><th class=\"n\">now</th><th>test</th><th class=\"n\">p</th><th class=\"n\">p among all "
      "tests</th><th></th></tr>";
  std::string differ, same;
  for (const Change& change : comparison.changes) (change.differs ? differ : same) += change_row(change, has_cells);
  if (!differ.empty()) html += head + differ + "</table></div>";
  if (!same.empty())
    html += "<details><summary>what does not differ in any run, or is not tested</summary>" + head + same + "</table></div></details>";
  return html;
}

}  // namespace lf::campaign
