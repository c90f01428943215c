// A campaign's progress on stderr, by the clock on the wall.
#pragma once

#include <string>

#include "host_sim/campaign/progress.hpp"

namespace lf::app {

class ProgressLine {
 public:
  ProgressLine(std::size_t total, const std::string& noun);
  ~ProgressLine();  // leaves the terminal's line empty
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void ended(bool failed) { progress_.ended(failed); }
  // Says what is due.
  void tick();
  // Before another line is written.
  void clear();

 private:
  campaign::Progress progress_;
};

}  // namespace lf::app
