// One line of an operator, read: a JSON object such as {"do": "jog", "joint": "elbow", "by_deg": -5}. A pure function of the line.
//
// The line is anybody's who can open the socket. Whatever its bytes are, the answer is a request that the daemon knows, with its arguments within their
// ranges, or one line that says what is wrong. Nothing is thrown.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <variant>

#include "firmware/mission/orders.hpp"
#include "hal/vehicle/joint_set.hpp"
#include "hal/vehicle/operator_rights.hpp"
#include "shared/arm/joint_names.hpp"
#include "shared/panel/panel_names.hpp"

namespace lf::hal {

// {"do": "commission", "joints": ["slew"], "clear": true}
struct CommissionOrder {
  JointSet joints = all_joints();
  bool here = false;   // the arm stands at its zero, in a jig: nothing moves
  bool moved = false;  // the encoder or the stop of the one joint was changed: its zero may be elsewhere
};

struct OperatorRequest {
  const Right* right = nullptr;  // the row of operator_rights(): never null
  bool for_the_core = false;     // `order` is to be given to the core; otherwise the daemon itself does it
  mission::Order order;
  CommissionOrder commission;
};

// The text says what is wrong: one line of valid UTF-8, at most some 200 letters.
using ParsedOrder = std::variant<OperatorRequest, std::string>;

// `names`: of the panel's features.
ParsedOrder parse_order(std::string_view line, const PanelNames& names = {}, const JointNames& joints = {});

}  // namespace lf::hal
