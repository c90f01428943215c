// "did you mean ...": the known name closest to a misspelt one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lf::config {

inline constexpr int most_edits = 1 << 30;

// Edits between two words: insertions, deletions, substitutions and swaps of neighbours (Damerau-Levenshtein, restricted), letters' case ignored.
// More than `most` are told as `most` + 1. O(|a| |b|).
int edit_distance(std::string_view a, std::string_view b, int most = most_edits);

// The shortest of `known` that begins with `word`, before an underscore rather than in a name's middle ("sweep_speed", "sweep_speed_rad_s"). Where none does,
// the nearest if it is near enough to be meant (a third of the shorter one's letters), otherwise none. Equal distances go to the one that comes first.
const std::string* nearest(std::string_view word, const std::vector<std::string>& known);
// "; did you mean 'x'?" for it, or "".
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

// Throws InputError, beginning with `option`, for the first of `given` that is not among `known`: with the nearest name, or with all of a few.
void check_names(const std::vector<std::string>& given, const std::vector<std::string>& known, const std::string& option);

}  // namespace lf::config
