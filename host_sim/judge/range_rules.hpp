// Which words in the reason of a mission's end name a key of the scenario as its cause: for runs whose keys were drawn over their ranges.
#pragma once

#include <string>
#include <vector>

namespace lf::judge {

// Parts of a reason that name this key; any one will do. What concerns one drive has to be named with its joint. Empty for a key that no end should come of.
std::vector<std::string> words_for(const std::string& key);

// Whether a reason names one of these keys by its cause: without the fault's own name, the advice in brackets and the step. Where a look says what it saw, that decides.
bool names_a_key(const std::vector<std::string>& keys, const std::string& reason);

// Whether the text of a refusal names one of these keys: by its path, or by its group and its last part as "drives.slew: 'counts_per_rev' is ..." does. A refusal
// for how two keys go together names the one that was drawn, or another that was.
bool refusal_names_a_key(const std::vector<std::string>& keys, const std::string& refusal);

}  // namespace lf::judge
