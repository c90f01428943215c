// What can go wrong in a simulated run: the names that a scenario uses, to what each happens, and what it does. One table for the reader of scenarios, the
// documentation, and the fault matrix.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/arm/joint_names.hpp"

namespace lf::config {

enum class FaultPlace : std::uint8_t {
  drive,           // needs a node: one of the joints
  node,            // needs a node: a drive or io
  node_or_master,  // needs a node: a drive, io or master
  frames,          // needs a can_id
  bus,             // the bus and what hangs on it, seen as one
  port,            // a call of the platform
  sight,           // camera and panel vision
  world,           // what the arm works on
  order,           // what an operator orders
  told,            // what the core is told before it starts: from power-on or not at all
};

struct FaultKind {
  const char* name;
  FaultPlace place;
  const char* does;  // a clause for the documentation
};

std::span<const FaultKind> fault_kinds();
// nullptr when there is none.
const FaultKind* find_fault_kind(std::string_view name);
std::vector<std::string> fault_kind_names();

// The nodes that a fault of this place can happen to, "" alone where it takes none.
std::vector<std::string> fault_nodes(FaultPlace place, const JointNames& names = {});

// A Markdown table of all kinds; docs/scenarios.md holds it.
std::string fault_kinds_markdown();

}  // namespace lf::config
