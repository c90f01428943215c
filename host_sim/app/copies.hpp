// Copies of this process (fork) that each come to one line of text: the rows of a campaign. A crash of one is one row that failed.
#pragma once

#include <sys/types.h>

#include <functional>
#include <map>
#include <string>

namespace lf::app {

class Copies {
 public:
  // How a copy without a line ended is told in words: "the run crashed by signal 11".
  struct Ended {
    std::string name;
    std::string line;     // what it came to, a line's end included; empty when it came to nothing
    std::string failure;  // then
  };
  // `ended` is called for each copy, in the process that starts them. It may throw: then the others run on unseen.
  Copies(int jobs, std::function<void(const Ended&)> ended) : jobs_(jobs), ended_(std::move(ended)) {}
  ~Copies();
  Copies(const Copies&) = delete;
  Copies& operator=(const Copies&) = delete;

  // Waits while as many run as may, then copies the process; `work` runs in the copy alone, which has one thread: the caller's.
  // Throws EnvironmentError when no process can be started.
  void start(const std::string& name, const std::function<std::string()>& work);
  // Waits for all.
  void finish();

 private:
  struct Running {
    int pipe = -1;
    std::string name;
  };

  void reap();

  int jobs_;
  std::function<void(const Ended&)> ended_;
  std::map<pid_t, Running> running_;
};

// Appends whole lines to a file, so that what a broken-off campaign has done is kept.
class LineFile {
 public:
  // Throws RecordError when it cannot be opened.
  explicit LineFile(const std::string& path);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;
  // Throws RecordError: full disk.
  void append(const std::string& line);

 private:
  std::string path_;
  int fd_ = -1;
};

}  // namespace lf::app
