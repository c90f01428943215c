// What an arm's joints and the nodes of its bus are called in files, messages and reports. Hosted side only: the core counts them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lf {

class JointNames {
 public:
  // The default machine's.
  JointNames() : names_{"slew", "shoulder", "elbow", "roll", "jaw"} {}
  // Of the arm's joints, base to tip, and of the jaw after them.
  explicit JointNames(std::vector<std::string> names) : names_(std::move(names)) {}

  std::size_t size() const { return names_.size(); }
  std::size_t arm_joints() const { return names_.size() - 1; }
  const std::string& operator[](std::size_t joint) const { return joint < names_.size() ? names_[joint] : unknown(); }
  auto begin() const { return names_.begin(); }
  auto end() const { return names_.end(); }
  std::optional<std::size_t> find(std::string_view name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    return found == names_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - names_.begin()));
  }
  // The first `count` of them: "slew, shoulder and elbow".
  std::string listed(std::size_t count) const {
    std::string all;
    for (std::size_t i = 0; i < count; ++i) all += (i == 0 ? "" : i + 1 == count ? " and " : ", ") + names_[i];
    return all;
  }

  // The drives in the order of their joints, then the output node.
  std::size_t node_count() const { return names_.size() + 1; }
  const std::string& node(std::size_t i) const {
    static const std::string io = "io";
    return i == names_.size() ? io : (*this)[i];
  }
  std::optional<std::size_t> find_node(std::string_view name) const { return name == node(size()) ? std::optional(size()) : find(name); }

  friend bool operator==(const JointNames&, const JointNames&) = default;

 private:
  static const std::string& unknown() {
    static const std::string mark = "?";
    return mark;
  }
  std::vector<std::string> names_;
};

}  // namespace lf
