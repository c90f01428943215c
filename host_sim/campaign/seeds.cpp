#include "host_sim/campaign/seeds.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "shared/input_error.hpp"

namespace lf::campaign {
namespace {

struct Range {
  std::uint64_t first = 0, last = 0;
};

std::optional<std::uint64_t> number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return !text.empty() && error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

Range range_of(const std::string& all, std::string_view part) {
  const std::size_t dash = part.find('-');
  const std::optional<std::uint64_t> first = number(part.substr(0, dash));
  const std::optional<std::uint64_t> last = dash == std::string_view::npos ? first : number(part.substr(dash + 1));
  const std::string in = part == all ? "" : " in '" + all + "'";
  if (!first || !last) throw InputError("--seeds takes seeds and ranges as 1,2,7-9, not '" + std::string(part) + "'" + in);
  if (*first > *last) throw InputError("--seeds " + std::string(part) + in + ": the first is above the last");
  if (*last - *first >= most_runs) throw InputError("--seeds " + std::string(part) + in + ": more than a million runs");
  return {*first, *last};
}

}  // namespace

std::vector<std::uint64_t> parse_seeds(const std::string& text) {
  std::vector<std::uint64_t> seeds;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const Range range = range_of(text, std::string_view(text).substr(from, to - from));
    if (seeds.size() + (range.last - range.first) >= most_runs) throw InputError("--seeds " + text + ": more than a million runs");
    for (std::uint64_t i = 0; i <= range.last - range.first; ++i) seeds.push_back(range.first + i);
    from = to + 1;
  }
  std::sort(seeds.begin(), seeds.end());
  const auto twice = std::adjacent_find(seeds.begin(), seeds.end());
  if (twice != seeds.end()) throw InputError("--seeds " + text + ": seed " + std::to_string(*twice) + " is given twice");
  return seeds;
}

}  // namespace lf::campaign
