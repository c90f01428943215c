#include "host_sim/campaign/progress.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace lf::campaign {

std::string duration_text(double seconds) {
  const long whole = std::lround(std::max(0.0, seconds));
  std::array<char, 64> text{};
  if (whole < 60) {
    std::snprintf(text.data(), text.size(), "%ld s", whole);
  } else if (whole < 3600) {
    std::snprintf(text.data(), text.size(), "%ld min %02ld s", whole / 60, whole % 60);
  } else {
    std::snprintf(text.data(), text.size(), "%ld h %02ld min", whole / 3600, whole % 3600 / 60);
  }
  return text.data();
}

std::string Progress::state(double now_s) const {
  std::string text = std::to_string(flown_) + " of " + std::to_string(total_) + " " + noun_ + (total_ == 1 ? "" : "s");
  if (failed_ > 0) text += ", " + std::to_string(failed_) + " failed";
  if (flown_ > 0 && flown_ < total_) {
    const double left_s = (now_s - begun_s_) / static_cast<double>(flown_) * static_cast<double>(total_ - flown_);
    text += ", about " + duration_text(left_s) + " left";
  }
  return text;
}

std::string Progress::tick(double now_s) {
  if (total_ == 0 || now_s < due_s_) return "";
  const double every_s = terminal_ ? 1 : 60;
  due_s_ = now_s + every_s;
  if (!terminal_) return state(now_s) + "\n";
  shown_ = true;
  return "\r" + state(now_s) + "\x1b[K";  // ECMA-48: erase to the line's end
}

std::string Progress::clear() {
  if (!shown_) return "";
  shown_ = false;
  due_s_ = -1;  // the next tick writes it again
  return "\r\x1b[K";
}

}  // namespace lf::campaign
