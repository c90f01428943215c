#include <array>
#include <cmath>
#include <cstdio>

#include "host_sim/campaign/comparison.hpp"

namespace lf::campaign {
namespace {

using Json = nlohmann::ordered_json;
using Verdict = Change::Verdict;

const char* word(Verdict verdict) { return verdict == Verdict::worse ? "worse" : verdict == Verdict::better ? "better" : "same"; }

std::string number(const char* format, double value) {
  std::array<char, 40> text;
  return {text.data(), static_cast<std::size_t>(std::snprintf(text.data(), text.size(), format, value))};
}

std::string line_of(const Change& change) {
  std::string what = change.cell.empty() ? "" : change.cell + ": ";
  what += change.figure + (change.before_counts.empty() ? " " + change.of : "");
  const std::string unit = change.unit.empty() ? "" : " " + change.unit;
  const std::string values = change.before_counts.empty() ? number("%.4g", change.before) + " -> " + number("%.4g", change.after) + unit
                                                          : change.before_counts + " -> " + change.after_counts;
  std::string line = std::string(word(change.verdict)) + ": " + what + ", " + values + " (" + change.test +
                     ", n = " + std::to_string(change.n) + ", p = " + number("%.2g", change.p);
  if (change.p_of_all != change.p) line += ", " + number("%.2g", change.p_of_all) + " among all tests";
  return line + ")\n";
}

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace

std::string text_of(const Comparison& comparison) {
  std::string text = "\nagainst " + comparison.with + ", over " + std::to_string(comparison.pairs) + " common seeds:\n";
  for (const std::string& note : comparison.notes) text += "note: " + note + "\n";
  for (const Turn& turn : comparison.turns) {
    text += (turn.cell.empty() ? "" : turn.cell + ", ") + "seed " + std::to_string(turn.seed) + ": was " + turn.before + ", is " +
            turn.after + "\n";
  }
  for (const Verdict verdict : {Verdict::worse, Verdict::better}) {
    for (const Change& change : comparison.changes) {
      if (change.verdict == verdict) text += line_of(change);
    }
  }
  if (comparison.identical) {
    text += "the runs of all common seeds are identical\n";
  } else if (comparison.tests == 0) {
    text += "no figure differs\n";
  } else if (!comparison.worse() && !comparison.better()) {
    text += "nothing is better or worse beyond chance\n";
  }
  if (!comparison.doubt.empty()) text += "doubtful: " + comparison.doubt + "\n";
  return text;
}

Json json_of(const Comparison& comparison) {
  Json changes = Json::array(), turns = Json::array();
  for (const Change& change : comparison.changes) {
    Json json = Json::object();
    if (!change.cell.empty()) json["cell"] = change.cell;
    json.update({{"figure", change.figure},
                 {"of", change.of},
                 {"before", finite(change.before)},
                 {"after", finite(change.after)},
                 {"n", change.n}});
    if (!change.test.empty())
      json.update({{"test", change.test}, {"p", change.p}, {"p_of_all", change.p_of_all}, {"verdict", word(change.verdict)}});
    changes.push_back(std::move(json));
  }
  for (const Turn& turn : comparison.turns) {
    Json json = Json::object();
    if (!turn.cell.empty()) json["cell"] = turn.cell;
    json.update({{"seed", turn.seed}, {"before", turn.before}, {"after", turn.after}});
    turns.push_back(std::move(json));
  }
  return {{"with", comparison.with},      {"common_seeds", comparison.pairs}, {"tests_that_differ", comparison.tests},
          {"worse", comparison.worse()},  {"better", comparison.better()},    {"identical", comparison.identical},
          {"doubt", comparison.doubt},    {"notes", comparison.notes},        {"turns", std::move(turns)},
          {"changes", std::move(changes)}};
}

}  // namespace lf::campaign
