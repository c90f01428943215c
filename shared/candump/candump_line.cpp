#include "shared/candump/candump_line.hpp"

#include <algorithm>
#include <cstdint>

namespace lf {

namespace {

constexpr std::uint32_t standard_mask = 0x7FF;
constexpr std::uint32_t extended_mask = 0x1FFFFFFF;

// A line has room for all that is put into it. By hand: a run writes 3300 lines a simulated second.
void append(CandumpLine& line, char c) { line.text[line.size++] = c; }

// With leading zeros to at least `digits`.
void append(CandumpLine& line, std::uint64_t value, int digits, unsigned base = 10) {
  std::array<char, 20> reversed;
  int count = 0;
  for (; value != 0 || count < digits; value /= base) reversed[static_cast<std::size_t>(count++)] = "0123456789ABCDEF"[value % base];
  while (count > 0) append(line, reversed[static_cast<std::size_t>(--count)]);
}

void append_hex(CandumpLine& line, std::uint32_t value, int digits) { append(line, value, digits, 16); }

}  // namespace

CandumpLine candump_line(Time t, const char* interface, const CanFrame& frame) noexcept {
  CandumpLine line;
  const std::int64_t us = std::max<std::int64_t>(0, t.ns() / 1000);
  append(line, '(');
  append(line, static_cast<std::uint64_t>(us / 1'000'000), 10);
  append(line, '.');
  append(line, static_cast<std::uint64_t>(us % 1'000'000), 6);
  append(line, ')');
  append(line, ' ');
  for (int i = 0; i < 15 && interface[i] != '\0'; ++i) append(line, interface[i]);
  append(line, ' ');
  if ((frame.id & CanFrame::error_flag) != 0) {
    append_hex(line, frame.id & (CanFrame::error_flag | extended_mask), 8);
  } else if ((frame.id & CanFrame::extended_flag) != 0) {
    append_hex(line, frame.id & extended_mask, 8);
  } else {
    append_hex(line, frame.id & standard_mask, 3);
  }
  append(line, '#');
  const unsigned length = std::min<unsigned>(frame.length, 8);
  if ((frame.id & CanFrame::remote_flag) != 0) {
    append(line, 'R');
    if (length > 0) append(line, length, 1);
  } else {
    for (unsigned i = 0; i < length; ++i) append_hex(line, frame.data[i], 2);
  }
  append(line, '\n');
  return line;
}

}  // namespace lf
