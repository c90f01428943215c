#include "host_sim/app/run_processes.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "host_sim/app/command.hpp"
#include "host_sim/app/interrupt.hpp"

namespace lf::app {

namespace {

constexpr std::chrono::milliseconds look_every{20};

// What a run that has ended had to say, its last lines.
std::string take_words(int pipe) {
  constexpr std::size_t most = 1000;
  std::string words;
  char bytes[4096];
  for (ssize_t got = 0; (got = read(pipe, bytes, sizeof bytes)) > 0;) words.append(bytes, static_cast<std::size_t>(got));
  close(pipe);
  while (words.ends_with('\n')) words.pop_back();
  return words.size() > most ? words.substr(words.size() - most) : words;
}

}  // namespace

RunProcesses::RunProcesses(std::size_t jobs, std::function<void(const Ended&)> ended, std::function<void()> waits)
    : jobs_(jobs), ended_(std::move(ended)), waits_(std::move(waits)), program_(std::filesystem::read_symlink("/proc/self/exe")) {}

RunProcesses::~RunProcesses() {
  for (const auto& [pid, run] : running_) {
    kill(pid, SIGINT);
    waitpid(pid, nullptr, 0);
    close(run.pipe);
  }
}

void RunProcesses::start(std::size_t id, std::vector<std::string> arguments) {
  while (running_.size() >= jobs_) reap();
  if (interrupted()) return;
  arguments.insert(arguments.begin(), program_);
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& word : arguments) argv.push_back(word.data());
  argv.push_back(nullptr);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) throw EnvironmentError("no pipe could be made for a run");
  const pid_t child = fork();
  if (child < 0) throw EnvironmentError("no process could be started for a run");
  if (child == 0) {
    // A terminal's Ctrl-C goes to the campaign alone, which passes it on: a second one would end a run at once, its record lost.
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    const int null = open("/dev/null", O_WRONLY);
    dup2(null, STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  close(ends[1]);
  running_[child] = {id, ends[0]};
}

void RunProcesses::finish() {
  while (!running_.empty()) reap();
}

void RunProcesses::reap() {
  int status = 0;
  pid_t child = 0;
  while ((child = waitpid(-1, &status, WNOHANG)) == 0) {
    if (interrupted() && !told_) {
      told_ = true;
      for (const auto& [pid, run] : running_) kill(pid, SIGINT);
    }
    waits_();
    std::this_thread::sleep_for(look_every);
  }
  if (child < 0) return running_.clear();  // there is none to wait for
  const auto found = running_.find(child);
  if (found == running_.end()) return;
  const Ended ended{found->second.id, status, take_words(found->second.pipe)};
  running_.erase(found);
  ended_(ended);
}

}  // namespace lf::app
