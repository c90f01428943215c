#include "hal/vehicle/can_error.hpp"

#include <linux/can/error.h>

namespace lf::hal {

void CanErrorCounts::add(const CanFrame& frame) {
  ++frames;
  const auto count = [](std::uint32_t& counter, bool present) { counter += present ? 1 : 0; };
  const std::uint32_t id = frame.id;
  const unsigned controller = (id & CAN_ERR_CRTL) != 0 ? frame.data[1] : 0U;
  count(bus_off, (id & CAN_ERR_BUSOFF) != 0);
  count(restarted, (id & CAN_ERR_RESTARTED) != 0);
  count(passive, (controller & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0);
  count(warning, (controller & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0);
  count(overrun, (controller & (CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW)) != 0);
  count(protocol, (id & (CAN_ERR_PROT | CAN_ERR_BUSERROR)) != 0);
  count(no_acknowledge, (id & CAN_ERR_ACK) != 0);
  count(lost_arbitration, (id & CAN_ERR_LOSTARB) != 0);
  count(transmit_timeout, (id & CAN_ERR_TX_TIMEOUT) != 0);
  count(transceiver, (id & CAN_ERR_TRX) != 0);
  constexpr std::uint32_t known = CAN_ERR_BUSOFF | CAN_ERR_RESTARTED | CAN_ERR_CRTL | CAN_ERR_PROT | CAN_ERR_BUSERROR | CAN_ERR_ACK |
                                  CAN_ERR_LOSTARB | CAN_ERR_TX_TIMEOUT | CAN_ERR_TRX;
  count(other, (id & known) == 0);
}

namespace {

struct Words {
  std::uint32_t bit;
  const char* text;
};

constexpr Words classes[] = {{CAN_ERR_BUSOFF, "bus off"},
                             {CAN_ERR_RESTARTED, "controller restarted"},
                             {CAN_ERR_TX_TIMEOUT, "transmit time-out"},
                             {CAN_ERR_LOSTARB, "arbitration lost"},
                             {CAN_ERR_PROT, "protocol violation"},
                             {CAN_ERR_BUSERROR, "bus error"},
                             {CAN_ERR_ACK, "no acknowledge"},
                             {CAN_ERR_TRX, "transceiver"}};

constexpr Words controller_states[] = {{CAN_ERR_CRTL_RX_OVERFLOW, "receive buffer overflow"},
                                       {CAN_ERR_CRTL_TX_OVERFLOW, "transmit buffer overflow"},
                                       {CAN_ERR_CRTL_RX_WARNING, "receive error warning"},
                                       {CAN_ERR_CRTL_TX_WARNING, "transmit error warning"},
                                       {CAN_ERR_CRTL_RX_PASSIVE, "receive error passive"},
                                       {CAN_ERR_CRTL_TX_PASSIVE, "transmit error passive"},
                                       {CAN_ERR_CRTL_ACTIVE, "error active again"}};

}  // namespace

std::string describe_can_error(const CanFrame& frame) {
  std::string text;
  const auto add = [&text](const char* words) { text += (text.empty() ? "" : ", ") + std::string(words); };
  for (const Words& one : classes) {
    if ((frame.id & one.bit) != 0) add(one.text);
  }
  if ((frame.id & CAN_ERR_CRTL) != 0) {
    for (const Words& one : controller_states) {
      if ((frame.data[1] & one.bit) != 0) add(one.text);
    }
  }
  return text.empty() ? "unknown error" : text;
}

}  // namespace lf::hal
