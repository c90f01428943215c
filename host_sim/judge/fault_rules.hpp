// What is asked of a mission to which a fault happens: whether it must stop, may end some other safe way, or has to go on; how it hears of the fault; and
// which words of its reason would name the cause.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/config/key.hpp"
#include "shared/arm/joint_names.hpp"

namespace lf::judge {

enum class Demand : std::uint8_t {
  stop,      // every drive is told to stop, stands and loses its power
  safe_end,  // it goes on, or ends: standing, named, and without doing harm
  go_on,     // it must not end the mission
};

// How the core can know, and so when its time to react begins.
enum class Report : std::uint8_t {
  frame,          // a frame says so: fault bit, EMCY, boot-up, open chain
  second_master,  // the first foreign frame
  silence,        // the last process data of the node
  halt,           // an order that is no emergency: the arm halts on its path within half a second
  at_once,        // the port or the operator says so in the tick after
  unheard,        // nothing that the core sends arrives: the drives stop by themselves when the master's heartbeat is missing
  none,           // to be found by watching the arm: no time is asked for
};

struct FaultRule {
  std::string kind;
  Demand demand = Demand::safe_end;
  Report report = Report::none;
  double duration_s = 0;  // 0: for the rest of the run
  // Parts of a reason that name this cause; any one will do. A cause at a node must be named with its node.
  std::vector<std::string> named_by;
  // Those that name it without its node, because the core cannot know the node.
  std::vector<std::string> named_without_node;
  const char* variant = "";           // tells rules of the same kind apart
  std::vector<std::string> frames{};  // of which sort, where frames are lost: tpdo, rpdo, heartbeat, emcy
};

std::span<const FaultRule> fault_rules();

// One fault as a row of the matrix has it.
struct Cause {
  const FaultRule* rule = nullptr;
  std::string node;         // or "tpdo slew", "heartbeat io" for lost frames
  std::uint8_t number = 0;  // of the node on the bus; 0: none, or the master
  bool output_node = false;
  std::int64_t lost_id = 0;  // of the frames that are lost; 0: none are

  std::string name() const;  // "overcurrent elbow"
  // Whether the reason says what happened, and at which node.
  bool named_in(const std::string& reason) const;
  config::Fault fault() const;
};

// The machine whose bus it is: its joints, and the numbers of their drives and of the output node after them.
struct BusNodes {
  JointNames names;
  std::vector<std::uint8_t> numbers = default_numbers();

  static std::vector<std::uint8_t> default_numbers();
};

// Each rule at each node that it can happen to.
std::vector<Cause> all_causes(const BusNodes& bus = {});

}  // namespace lf::judge
