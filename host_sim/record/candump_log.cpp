#include "host_sim/record/candump_log.hpp"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <utility>

namespace lf::record {
namespace {

constexpr std::uint32_t standard_mask = 0x7FF;
constexpr std::uint32_t extended_mask = 0x1FFFFFFF;

// "(sec.usec) " and " can0 " and the frame: at most 12 + 8 + 3 + 16 characters beside the interface's name.
struct Line {
  std::array<char, 96> text;
  std::size_t size = 0;

  std::string_view view() const { return {text.data(), size}; }
};

template <class... Arguments>
void append(Line& line, const char* format, Arguments... arguments) {
  const int written = std::snprintf(line.text.data() + line.size, line.text.size() - line.size, format, arguments...);
  if (written > 0) line.size = std::min(line.text.size() - 1, line.size + static_cast<std::size_t>(written));
}

Line format_line(Time t, const char* interface, const CanFrame& frame) noexcept {
  Line line;
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

}  // namespace

std::string candump_line(Time t, const std::string& interface, const CanFrame& frame) {
  return std::string(format_line(t, interface.c_str(), frame).view());
}

CandumpLog::CandumpLog(const std::filesystem::path& path, std::string interface) : sink_(path), interface_(std::move(interface)) {}

bool CandumpLog::write(Time t, const CanFrame& frame) noexcept {
  if (!sink_.write(format_line(t, interface_.c_str(), frame).view())) return false;
  ++frames_;
  return true;
}

}  // namespace lf::record
