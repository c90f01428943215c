#include "host_sim/app/progress_line.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace lf::app {

namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void say(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

ProgressLine::ProgressLine(std::size_t total, const std::string& noun) : progress_(total, noun, isatty(STDERR_FILENO) != 0, now_s()) {
  tick();
}

ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::tick() { say(progress_.tick(now_s())); }

void ProgressLine::clear() { say(progress_.clear()); }

}  // namespace lf::app
