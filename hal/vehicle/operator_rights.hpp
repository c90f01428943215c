// Who may do what: three roles, and the orders and requests each may give. When an order is possible is the mission's affair (firmware/mission/orders.hpp).
//
// docs/operating.md holds the table; a test draws it again from this one and compares.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lf::hal {

enum class Role : std::uint8_t {
  watcher,   // everyone who can open the socket
  pilot,     // runs missions; `operator` to the user, a word that C++ keeps for itself
  engineer,  // the daemon's own user, root, and who is named so
};
inline constexpr std::size_t role_count = 3;
const char* name(Role role);

struct Right {
  const char* request;
  Role least;  // who may, and everyone above
  const char* does;
  const char* line;  // that asks for it
};

const std::vector<Right>& operator_rights();
// The row of a request; nullptr for one that there is none of.
const Right* right_of(std::string_view request);

// The role of a user: by number, name and groups. Names that begin with @ are groups'.
Role role_of_user(unsigned user, const std::vector<std::string>& operators, const std::vector<std::string>& engineers);

}  // namespace lf::hal
