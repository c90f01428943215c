#include "host_sim/serve/node_set.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "shared/can/can_map.hpp"
#include "shared/input_error.hpp"

namespace lf::serve {

namespace {

[[noreturn]] void refuse(const std::string& text) {
  throw InputError("--nodes " + text + ": takes node numbers of the CAN map, as 1-5 or 1,3,6, or all, or none");
}

int number(const std::string& word, const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) refuse(text);
  return value;
}

}  // namespace

std::uint8_t node_in(std::size_t slot) { return slot < can_map::drive_nodes.size() ? can_map::drive_nodes[slot] : can_map::io_node; }

NodeSet NodeSet::all() {
  NodeSet set;
  set.served_.fill(true);
  return set;
}

NodeSet NodeSet::parse(const std::string& text) {
  if (text == "all") return all();
  NodeSet set;
  if (text == "none") return set;
  std::stringstream list(text);
  bool any = false;
  for (std::string part; std::getline(list, part, ',');) {
    const std::size_t dash = part.find('-', 1);
    const int first = number(part.substr(0, dash), text);
    const int last = dash == std::string::npos ? first : number(part.substr(dash + 1), text);
    if (last < first) refuse(text);
    for (int node = first; node <= last; ++node) {
      std::size_t slot = 0;
      while (slot <= can_map::drive_nodes.size() && node_in(slot) != node) ++slot;
      if (slot > can_map::drive_nodes.size()) refuse(text);
      set.served_[slot] = any = true;
    }
  }
  if (!any) refuse(text);
  return set;
}

bool NodeSet::empty() const {
  return std::none_of(served_.begin(), served_.end(), [](bool served) { return served; });
}

bool NodeSet::is_all() const {
  return std::all_of(served_.begin(), served_.end(), [](bool served) { return served; });
}

std::string NodeSet::text() const {
  std::string text;
  for (std::size_t slot = 0; slot <= can_map::drive_nodes.size(); ++slot) {
    if (served_[slot]) text += (text.empty() ? "" : ", ") + std::to_string(node_in(slot));
  }
  return text.empty() ? "none" : text;
}

}  // namespace lf::serve
