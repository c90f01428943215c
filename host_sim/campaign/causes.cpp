#include "host_sim/campaign/causes.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace lf::campaign {
namespace {

constexpr std::array<std::string_view, 16> units{"N", "N m", "mm", "m",  "deg", "degrees", "rad",   "rad/s",
                                                 "s", "ms",  "us", "px", "%",   "Nm",      "per m", "dB"};

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Where a unit stands at the start of `rest`, after a blank or none, and no word goes on after it.
bool has_unit(std::string_view rest) {
  if (rest.starts_with(' ')) rest.remove_prefix(1);
  return std::any_of(units.begin(), units.end(), [&](std::string_view unit) {
    return rest.starts_with(unit) && (rest.size() == unit.size() || !is_word(rest[unit.size()]));
  });
}

// The number that begins at `at`: its end, and whether it has a decimal point.
std::pair<std::size_t, bool> number_at(const std::string& text, std::size_t at) {
  bool has_point = false;
  while (at < text.size() && (is_digit(text[at]) || (text[at] == '.' && !has_point && at + 1 < text.size() && is_digit(text[at + 1])))) {
    has_point = has_point || text[at] == '.';
    ++at;
  }
  return {at, has_point};
}

}  // namespace

std::string cause_of(const std::string& reason) {
  std::string cause;
  for (std::size_t at = 0; at < reason.size();) {
    const bool begins = is_digit(reason[at]) && (at == 0 || !is_word(reason[at - 1]));
    if (!begins) {
      cause += reason[at++];
      continue;
    }
    const auto [end, has_point] = number_at(reason, at);
    const std::string_view rest = std::string_view(reason).substr(end);
    const bool measured = has_point ? rest.empty() || !is_word(rest[0]) || has_unit(rest) : has_unit(rest);
    if (measured && cause.ends_with('-')) cause.pop_back();  // its sign
    cause += measured ? "…" : reason.substr(at, end - at);
    at = end;
  }
  return cause;
}

std::vector<Cause> causes_of(const Campaign& campaign) {
  std::vector<Cause> causes;
  for (std::size_t c = 0; c < campaign.cells.size(); ++c) {
    const std::vector<RunSummary>& runs = campaign.cells[c].runs;
    for (std::size_t r = 0; r < runs.size(); ++r) {
      if (runs[r].success) continue;
      const record::FailureRecord failure = runs[r].failure.value_or(record::FailureRecord{"?", "no reason was given"});
      const std::string text = cause_of(failure.reason);
      const auto same = [&](const Cause& known) {
        return known.phase == failure.phase && known.cause == text && known.false_success == runs[r].false_success;
      };
      auto found = std::find_if(causes.begin(), causes.end(), same);
      if (found == causes.end()) found = causes.insert(causes.end(), Cause{failure.phase, text, failure.reason, runs[r].false_success, {}});
      found->runs.emplace_back(c, r);
    }
  }
  std::stable_sort(causes.begin(), causes.end(), [](const Cause& a, const Cause& b) {
    return a.false_success != b.false_success ? a.false_success : a.runs.size() > b.runs.size();
  });
  return causes;
}

}  // namespace lf::campaign
