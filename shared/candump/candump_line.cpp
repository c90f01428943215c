#include "shared/candump/candump_line.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

namespace lf {

namespace {

constexpr std::uint32_t standard_mask = 0x7FF;
constexpr std::uint32_t extended_mask = 0x1FFFFFFF;

template <class... Arguments>
void append(CandumpLine& line, const char* format, Arguments... arguments) {
  const int written = std::snprintf(line.text.data() + line.size, line.text.size() - line.size, format, arguments...);
  if (written > 0) line.size = std::min(line.text.size() - 1, line.size + static_cast<std::size_t>(written));
}

}  // namespace

CandumpLine candump_line(Time t, const char* interface, const CanFrame& frame) noexcept {
  CandumpLine line;
  const std::int64_t us = std::max<std::int64_t>(0, t.ns() / 1000);
  append(line, "(%010" PRId64 ".%06" PRId64 ") %.15s ", us / 1'000'000, us % 1'000'000,
         interface);  // interface names have at most 15 characters
  if ((frame.id & CanFrame::error_flag) != 0) {
    append(line, "%08X#", frame.id & (CanFrame::error_flag | extended_mask));
  } else if ((frame.id & CanFrame::extended_flag) != 0) {
    append(line, "%08X#", frame.id & extended_mask);
  } else {
    append(line, "%03X#", frame.id & standard_mask);
  }
  const unsigned length = std::min<unsigned>(frame.length, 8);
  if ((frame.id & CanFrame::remote_flag) != 0) {
    append(line, "R");
    if (length > 0) append(line, "%u", length);
  } else {
    for (unsigned i = 0; i < length; ++i) append(line, "%02X", static_cast<unsigned>(frame.data[i]));
  }
  append(line, "\n");
  return line;
}

}  // namespace lf
