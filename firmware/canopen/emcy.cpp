#include "firmware/canopen/emcy.hpp"

#include <algorithm>
#include <array>

#include "firmware/canopen/cob_id.hpp"
#include "firmware/canopen/codec.hpp"

namespace lf::canopen {

namespace {

struct CodeName {
  std::uint16_t code;
  std::uint16_t mask;
  const char* name;
};

// Exact codes first, then classes: the first row that fits counts.
constexpr std::array<CodeName, 43> code_names{{
    {0x0000, 0xFFFF, "no error, or error gone"},
    {0x2310, 0xFFFF, "continuous over-current"},
    {0x2320, 0xFFFF, "short circuit"},
    {0x2350, 0xFFFF, "load level (i2t, thermal state)"},
    {0x3210, 0xFFFF, "DC link over-voltage"},
    {0x3220, 0xFFFF, "DC link under-voltage"},
    {0x4210, 0xFFFF, "drive over-temperature"},
    {0x4310, 0xFFFF, "motor over-temperature"},
    {0x5441, 0xFFFF, "safe torque off"},
    {0x6320, 0xFFFF, "parameter error"},
    {0x7120, 0xFFFF, "motor blocked"},
    {0x7121, 0xFFFF, "motor blocked"},
    {0x7305, 0xFFFF, "position sensor 1"},
    {0x7306, 0xFFFF, "position sensor 2"},
    {0x8110, 0xFFFF, "CAN overrun: messages lost"},
    {0x8120, 0xFFFF, "CAN error passive"},
    {0x8130, 0xFFFF, "heartbeat lost"},
    {0x8140, 0xFFFF, "recovered from bus-off"},
    {0x8150, 0xFFFF, "CAN identifier collision"},
    {0x8210, 0xFFFF, "PDO not processed: length"},
    {0x8220, 0xFFFF, "PDO length exceeded"},
    {0x8240, 0xFFFF, "unexpected SYNC length"},
    {0x8250, 0xFFFF, "RPDO time-out"},
    {0x8611, 0xFFFF, "following error"},
    {0x8612, 0xFFFF, "reference limit"},
    {0x1000, 0xFF00, "generic error"},
    {0x2100, 0xFF00, "input current"},
    {0x2200, 0xFF00, "internal current"},
    {0x2300, 0xFF00, "output current"},
    {0x2000, 0xF000, "current"},
    {0x3100, 0xFF00, "mains voltage"},
    {0x3000, 0xF000, "voltage"},
    {0x4000, 0xF000, "temperature"},
    {0x5000, 0xFF00, "device hardware"},
    {0x5000, 0xF000, "device hardware"},
    {0x6000, 0xF000, "device software"},
    {0x7000, 0xF000, "additional modules"},
    {0x8100, 0xFF00, "communication"},
    {0x8200, 0xFF00, "protocol"},
    {0x8000, 0xF000, "monitoring"},
    {0x9000, 0xF000, "external error"},
    {0xF000, 0xFF00, "additional functions"},
    {0xFF00, 0xFF00, "device specific"},
}};

}  // namespace

const char* emcy_name(std::uint16_t code) {
  const auto* row = std::find_if(code_names.begin(), code_names.end(), [code](const CodeName& c) { return (code & c.mask) == c.code; });
  return row == code_names.end() ? "unknown" : row->name;
}

Emcy decode_emcy(const CanFrame& frame, Time now) {
  return {get<std::uint16_t>(frame, 0), get<std::uint8_t>(frame, 2), cob_id::node_of(frame.id), now};
}

}  // namespace lf::canopen
