#include "hal/config/key_listing.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <vector>

#include "hal/config/key_text.hpp"

namespace lf::config {

namespace {

constexpr std::size_t comments_from = 44;  // letters before a comment, so that most of them stand in one column

std::vector<std::string> parts_of(const std::string& path) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', begin)) {
    parts.push_back(path.substr(begin, dot - begin));
    begin = dot + 1;
  }
  parts.push_back(path.substr(begin));
  return parts;
}

// The keys' places in the table, but with all of a group where its first one stands: a group that is written twice is refused.
std::vector<std::size_t> by_groups(const Keys& table) {
  std::map<std::string, std::size_t> first;
  std::vector<std::vector<std::size_t>> ranks;  // for each key the first place of every group that it is in, then its own
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string& path = table[i].path;
    std::vector<std::size_t> rank;
    for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1))
      rank.push_back(first.emplace(path.substr(0, dot), i).first->second);
    rank.push_back(i);
    ranks.push_back(std::move(rank));
  }
  std::vector<std::size_t> order(table.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return ranks[a] < ranks[b]; });
  return order;
}

std::string comment_of(const Key& key, const std::string& value, const std::string& usual) {
  std::string text = key.doc;
  if (!key.words.empty()) text += "; " + type_name(key);
  if (key.min < key.max) text += "; " + number_text(key.min) + " to " + number_text(key.max);
  if (!key.unit.empty()) text += (key.min < key.max ? " " : "; ") + key.unit;
  if (value != usual) text += "; default " + usual;
  return text;
}

}  // namespace

std::string key_listing(const Keys& table, const Keys& defaults) {
  std::string out;
  std::vector<std::string> open;  // the groups that the line before was in
  for (const std::size_t i : by_groups(table)) {
    std::vector<std::string> parts = parts_of(table[i].path);
    const std::string name = parts.back();
    parts.pop_back();
    const auto same = static_cast<std::size_t>(std::mismatch(open.begin(), open.end(), parts.begin(), parts.end()).first - open.begin());
    for (std::size_t depth = same; depth < parts.size(); ++depth) out += std::string(2 * depth, ' ') + parts[depth] + ":\n";
    open = parts;
    const std::string value = value_text(table[i]);
    const std::string line = std::string(2 * parts.size(), ' ') + name + ": " + value;
    const std::size_t blanks = line.size() < comments_from ? comments_from - line.size() : 1;
    // Another arm's drives have no defaults of their own names.
    const auto usual = std::find_if(defaults.begin(), defaults.end(), [&](const Key& key) { return key.path == table[i].path; });
    out +=
        line + std::string(blanks, ' ') + "# " + comment_of(table[i], value, usual == defaults.end() ? value : value_text(*usual)) + "\n";
  }
  return out;
}

}  // namespace lf::config
