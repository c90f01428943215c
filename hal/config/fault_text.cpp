#include "hal/config/fault_text.hpp"

#include <array>
#include <cstdio>

#include "firmware/telemetry.hpp"
#include "hal/config/cause.hpp"
#include "shared/messages/joint_io.hpp"

namespace lf::config {

namespace {

using safety::Fault;

std::string hex(unsigned value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%04X", value);
  return text;
}

// `code`: the port whose calls fail; 0: the controller itself says so.
std::string bus_text(std::int32_t code) {
  switch (static_cast<Port>(code)) {
    case Port::can_receive: return "receiving fails";
    case Port::can_send: return "sending fails";
    default: return "";
  }
}

std::string cause(Fault fault, std::int32_t code, const ErrorTexts& texts, const mission::Sight& sight) {
  switch (fault) {
    case Fault::node_lost:
    case Fault::node_rebooted:
    case Fault::drive_fault:
    case Fault::following_error:
    case Fault::stale_position:
    case Fault::joint_limit:
    case Fault::overspeed:
    case Fault::overload:
    case Fault::unexpected_contact: return texts.node_name(code);
    case Fault::boot_failed: return code < 0 ? "" : texts.node_name(code);
    case Fault::step_failed:
    case Fault::vision_poor: return cause_of(fault, code, sight).name;
    case Fault::second_master: return "identifier " + hex(static_cast<unsigned>(code));
    case Fault::estop: return code == 0 ? "the chain is open" : "by order";
    case Fault::aborted: return code == 0 ? "" : "shut down by order";
    case Fault::bus_off: return bus_text(code);
    case Fault::io_lost: return "";
    default: return code == 0 ? "" : std::to_string(code);
  }
}

}  // namespace

std::string fault_text(Fault fault, std::int32_t code, std::uint16_t emcy, const ErrorTexts& texts, const mission::Sight& sight) {
  std::string text = safety::name(fault);
  if (const std::string why = cause(fault, code, texts, sight); !why.empty()) text += ": " + why;
  const bool failed = fault == Fault::step_failed || fault == Fault::vision_poor;
  if (const std::string what_to_do = failed ? cause_of(fault, code, sight).remedy : ""; !what_to_do.empty())
    text += " (" + what_to_do + ")";
  // Every fault that an EMCY comes with has its node's index for a code.
  if (emcy != 0) text += ", EMCY " + hex(emcy) + " (" + texts.of_joint(code, emcy) + ")";
  return text;
}

}  // namespace lf::config
