// What a campaign says while it flies: how far it is, and how long it will take.
#pragma once

#include <cstddef>
#include <string>

namespace lf::campaign {

// "40 s", "3 min 20 s", "2 h 05 min".
std::string duration_text(double seconds);

// The time is passed in, in seconds from any origin.
class Progress {
 public:
  // `total` counts what is to be flown now, without what is kept. On a terminal one line is written anew every second; without one there is a line when it
  // begins and one a minute. `noun`: "run", "row".
  Progress(std::size_t total, std::string noun, bool terminal, double now_s)
      : total_(total), noun_(std::move(noun)), terminal_(terminal), begun_s_(now_s) {}

  void ended(bool failed) {
    ++flown_;
    failed_ += failed ? 1 : 0;
  }

  // "12 of 50 runs, 1 failed, about 3 min 20 s left". The time left is that of those flown so far, a run each; before the first has ended it is unknown.
  std::string state(double now_s) const;

  // What is to be written at this time; mostly nothing.
  std::string tick(double now_s);
  // What takes the line away from a terminal, before another line is written or at the end.
  std::string clear();

 private:
  std::size_t total_;
  std::string noun_;
  bool terminal_;
  double begun_s_;
  double due_s_ = -1;  // below 0: nothing was said yet
  std::size_t flown_ = 0, failed_ = 0;
  bool shown_ = false;
};

}  // namespace lf::campaign
