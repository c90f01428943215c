// A hand-made master for tests: it speaks frames to one node and reads what comes back. Independent of the core's master.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/devices/canopen/node.hpp"

namespace lf::devices::test {

class Client {
 public:
  explicit Client(Node& node) : node_(node) {}

  CanFrame frame(std::uint32_t id, std::vector<std::uint8_t> data) const {
    CanFrame f;
    f.id = id;
    f.length = static_cast<std::uint8_t>(data.size());
    std::copy(data.begin(), data.end(), f.data.begin());
    return f;
  }

  // Sends and returns what the node answered at once.
  std::vector<CanFrame> send(std::uint32_t id, std::vector<std::uint8_t> data) {
    node_.outbox().clear();
    node_.receive(frame(id, std::move(data)), now);
    return take();
  }
  std::vector<CanFrame> take() {
    std::vector<CanFrame> frames = node_.outbox();
    node_.outbox().clear();
    return frames;
  }
  void nmt(std::uint8_t command) { send(0, {command, node_.id()}); }
  std::vector<CanFrame> sync() { return send(0x80, {}); }

  static std::uint32_t u32(const CanFrame& f, std::size_t at) {
    return f.data[at] | (std::uint32_t{f.data[at + 1]} << 8) | (std::uint32_t{f.data[at + 2]} << 16) |
           (std::uint32_t{f.data[at + 3]} << 24);
  }

  // One SDO request and its answer's eight bytes; length 0 when there was none.
  CanFrame sdo(std::vector<std::uint8_t> request) {
    for (const CanFrame& f : send(0x600u + node_.id(), std::move(request))) {
      if (f.id == 0x580u + node_.id()) return f;
    }
    return {};
  }

  // Expedited download: the abort code, 0 when accepted.
  std::uint32_t write(std::uint16_t index, std::uint8_t sub, std::int64_t value, std::size_t bytes) {
    std::vector<std::uint8_t> request{static_cast<std::uint8_t>(0x23 | ((4 - bytes) << 2)), static_cast<std::uint8_t>(index & 0xFF),
                                      static_cast<std::uint8_t>(index >> 8), sub};
    for (std::size_t i = 0; i < 4; ++i) request.push_back(i < bytes ? static_cast<std::uint8_t>(value >> (8 * i)) : 0);
    const CanFrame answer = sdo(request);
    if (answer.length != 8) return 0xFFFFFFFF;
    return answer.data[0] == 0x80 ? u32(answer, 4) : (answer.data[0] == 0x60 ? 0 : 0xFFFFFFFE);
  }

  // Expedited upload as raw bits; the abort code comes back in `abort`.
  std::uint32_t read(std::uint16_t index, std::uint8_t sub, std::uint32_t* abort = nullptr) {
    const CanFrame answer = sdo({0x40, static_cast<std::uint8_t>(index & 0xFF), static_cast<std::uint8_t>(index >> 8), sub, 0, 0, 0, 0});
    if (abort != nullptr) *abort = answer.data[0] == 0x80 ? u32(answer, 4) : 0;
    const std::size_t bytes = 4u - ((answer.data[0] >> 2) & 3u);
    std::uint32_t value = u32(answer, 4);
    if (bytes < 4) value &= (1u << (8 * bytes)) - 1;
    return value;
  }

  // Re-maps a PDO in the order of CiA 301; the first abort code, or 0.
  std::uint32_t map(std::uint16_t communication, std::uint32_t cob_id, std::uint8_t type, const std::vector<std::uint32_t>& entries) {
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    std::uint32_t code = write(communication, 1, cob_id | 0x80000000u, 4);
    if (code == 0) code = write(communication, 2, type, 1);
    if (code == 0) code = write(mapping, 0, 0, 1);
    for (std::size_t i = 0; i < entries.size() && code == 0; ++i) code = write(mapping, static_cast<std::uint8_t>(i + 1), entries[i], 4);
    if (code == 0) code = write(mapping, 0, static_cast<std::int64_t>(entries.size()), 1);
    return code == 0 ? write(communication, 1, cob_id, 4) : code;
  }

  Time now;

 private:
  Node& node_;
};

// The last emergency among `frames`: its code, or -1.
inline int emergency(const std::vector<CanFrame>& frames, std::uint8_t node) {
  int code = -1;
  for (const CanFrame& f : frames) {
    if (f.id == 0x80u + node) code = f.data[0] | (f.data[1] << 8);
  }
  return code;
}

}  // namespace lf::devices::test
