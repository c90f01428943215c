#include "host_sim/app/copies.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "host_sim/app/command.hpp"
#include "host_sim/record/file_sink.hpp"

#ifdef LANTERNFISH_COUNTS_LINES
extern "C" void __gcov_dump(void);  // of libgcov: what a copy has executed is lost at _exit
#endif

namespace lf::app {

namespace {

void write_coverage() {
#ifdef LANTERNFISH_COUNTS_LINES
  __gcov_dump();
#endif
}

bool write_all(int fd, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t wrote = ::write(fd, text.data() + done, text.size() - done);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return false;
    done += static_cast<std::size_t>(wrote);
  }
  return true;
}

}  // namespace

Copies::~Copies() {
  for (const auto& [child, running] : running_) {
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    ::close(running.pipe);
  }
}

void Copies::start(const std::string& name, const std::function<std::string()>& work) {
  while (running_.size() >= static_cast<std::size_t>(jobs_)) reap();
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw EnvironmentError("no pipe could be made for a row");
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) throw EnvironmentError("no process could be started for a row");
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    int status = 1;
    try {
      status = write_all(ends[1], work()) ? 0 : 1;
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
    }
    write_coverage();
    _exit(status);
  }
  ::close(ends[1]);
  running_[child] = {ends[0], name};
}

void Copies::finish() {
  while (!running_.empty()) reap();
}

void Copies::reap() {
  int status = 0;
  const pid_t child = waitpid(-1, &status, 0);
  const auto found = running_.find(child);
  if (found == running_.end()) return;  // an interrupt
  Ended ended;
  ended.name = found->second.name;
  char bytes[4096];
  for (ssize_t got = 0; (got = ::read(found->second.pipe, bytes, sizeof bytes)) > 0;)
    ended.line.append(bytes, static_cast<std::size_t>(got));
  ::close(found->second.pipe);
  running_.erase(found);
  if (ended.line.empty() || ended.line.back() != '\n') {
    ended.line.clear();
    ended.failure = WIFSIGNALED(status) ? "the run crashed by signal " + std::to_string(WTERMSIG(status)) : "the run came to nothing";
  }
  ended_(ended);
}

LineFile::LineFile(const std::string& path) : path_(path), fd_(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644)) {
  if (fd_ < 0) throw record::RecordError(path_ + ": " + std::strerror(errno));
}

LineFile::~LineFile() { ::close(fd_); }

void LineFile::append(const std::string& line) {
  if (!write_all(fd_, line)) throw record::RecordError(path_ + ": " + std::strerror(errno));
}

}  // namespace lf::app
