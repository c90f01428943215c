// Runs of the program (`lanternfish run ...`) in processes of their own: a crash of one is one failed run, and nothing is shared that could make runs differ.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace lf::app {

class RunProcesses {
 public:
  struct Ended {
    std::size_t id = 0;
    int status = 0;     // of waitpid()
    std::string words;  // the last that it said on stderr
  };
  // `ended` is called for each; `waits` some fifty times a second while there is nothing to do. Either may throw: the processes end with this object then.
  RunProcesses(std::size_t jobs, std::function<void(const Ended&)> ended, std::function<void()> waits);
  ~RunProcesses();
  RunProcesses(const RunProcesses&) = delete;
  RunProcesses& operator=(const RunProcesses&) = delete;

  // Waits while `jobs` run, then starts `lanternfish ARGUMENTS`; not when an interrupt came meanwhile. Throws EnvironmentError when no process can be made.
  void start(std::size_t id, std::vector<std::string> arguments);
  // Waits for all. An interrupt is passed on to them, once.
  void finish();

 private:
  struct Running {
    std::size_t id = 0;
    int pipe = -1;
  };

  void reap();

  std::size_t jobs_;
  std::function<void(const Ended&)> ended_;
  std::function<void()> waits_;
  std::string program_;
  std::map<pid_t, Running> running_;
  bool told_ = false;  // the runs, that they are interrupted
};

}  // namespace lf::app
