#include <array>
#include <cmath>
#include <cstdio>

#include "host_sim/record/report_parts.hpp"

namespace lf::record {
namespace {

// Length of the UTF-8 sequence at `text`'s start, 0 when there is none (RFC 3629).
std::size_t sequence_length(std::string_view text) {
  const auto byte = [&](std::size_t i) -> unsigned { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto tails = [&](std::size_t count) {
    for (std::size_t i = 1; i <= count; ++i) {
      if ((byte(i) & 0xC0u) != 0x80u) return false;
    }
    return true;
  };
  const unsigned lead = byte(0), second = byte(1);
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF && tails(1)) return 2;
  const bool three = lead >= 0xE0 && lead <= 0xEF && tails(2) && !(lead == 0xE0 && second < 0xA0) && !(lead == 0xED && second > 0x9F);
  if (three) return 3;
  const bool four = lead >= 0xF0 && lead <= 0xF4 && tails(3) && !(lead == 0xF0 && second < 0x90) && !(lead == 0xF4 && second > 0x8F);
  return four ? 4 : 0;
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string escaped;
  while (!text.empty()) {
    const std::size_t length = sequence_length(text);
    const char c = text.front();
    if (length == 0) {
      escaped += "\xEF\xBF\xBD";
    } else if (length > 1) {
      escaped += text.substr(0, length);
    } else if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else if (c == '\'') {
      escaped += "&#39;";
    } else {
      escaped += static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' ? ' ' : c;
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return escaped;
}

std::string formatted(const char* format, double value) {
  if (!std::isfinite(value)) return "–";
  std::array<char, 64> text;
  const int size = std::snprintf(text.data(), text.size(), format, value);
  return {text.data(), static_cast<std::size_t>(size < 0 ? 0 : std::min<int>(size, text.size() - 1))};
}

}  // namespace lf::record
