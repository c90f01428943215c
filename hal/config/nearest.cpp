#include "hal/config/nearest.hpp"

#include <algorithm>

#include "shared/input_error.hpp"

namespace lf::config {

namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

int edit_distance(std::string_view a, std::string_view b, int most) {
  // So many edits as the lengths differ by are needed at least.
  const auto [shorter, longer] = std::minmax({a.size(), b.size()});
  if (longer - shorter > static_cast<std::size_t>(most)) return most + 1;
  std::vector<int> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int change = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + change});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    // What follows is made from these two rows, and is never less.
    if (std::min(*std::min_element(row.begin(), row.end()), *std::min_element(last.begin(), last.end())) > most) return most + 1;
    before.swap(last);
    last.swap(row);
  }
  return std::min(last[b.size()], most + 1);
}

namespace {

// Names end in their units: the shortest that goes on where the word ends, at an underscore if there is one.
const std::string* continued(std::string_view word, const std::vector<std::string>& known) {
  constexpr std::size_t fewest_letters = 3;
  if (word.size() < fewest_letters) return nullptr;
  const std::string* best = nullptr;
  bool best_at_end = false;
  for (const std::string& name : known) {
    if (!std::string_view(name).starts_with(word)) continue;
    const bool at_end = name.size() == word.size() || name[word.size()] == '_';
    if (best != nullptr && (best_at_end > at_end || (best_at_end == at_end && best->size() <= name.size()))) continue;
    best = &name;
    best_at_end = at_end;
  }
  return best;
}

}  // namespace

const std::string* nearest(std::string_view word, const std::vector<std::string>& known) {
  if (const std::string* longer = continued(word, known)) return longer;
  const std::string* best = nullptr;
  int fewest = 0;
  for (const std::string& name : known) {
    const auto most = static_cast<int>(std::min(word.size(), name.size())) / 3;
    const int edits = edit_distance(word, name, most);
    if (edits <= most && (best == nullptr || edits < fewest)) {
      best = &name;
      fewest = edits;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
  const std::string* near = nearest(word, known);
  return near == nullptr ? "" : "; did you mean '" + *near + "'?";
}

namespace {

// What there is, where nothing is near and the list is short.
std::string choices(const std::vector<std::string>& known) {
  constexpr std::size_t most = 60;
  if (known.empty() || known.size() > most) return "";
  std::string text = "; it is one of ";
  for (std::size_t i = 0; i < known.size(); ++i) text += (i == 0 ? "" : i + 1 == known.size() ? " or " : ", ") + known[i];
  return text;
}

}  // namespace

void check_names(const std::vector<std::string>& given, const std::vector<std::string>& known, const std::string& option) {
  for (const std::string& name : given) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string near = suggestion(name, known);
    throw InputError(option + ": there is no '" + name + "'" + (near.empty() ? choices(known) : near));
  }
}

}  // namespace lf::config
