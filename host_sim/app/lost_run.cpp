#include "host_sim/app/lost_run.hpp"

#include <sys/wait.h>

#include "host_sim/app/command.hpp"

namespace lf::app {

std::string lost_reason(int status, const std::string& words, const std::string& difference) {
  std::string reason;
  if (WIFSIGNALED(status)) {
    reason = "ended by signal " + std::to_string(WTERMSIG(status));
  } else if (WEXITSTATUS(status) == bad_input) {
    reason = "refused";
  } else if (WEXITSTATUS(status) <= failed && !difference.empty()) {
    reason = "something changed since the campaign began: " + difference;
  } else {
    reason = "exit status " + std::to_string(WEXITSTATUS(status));
  }
  return words.empty() ? reason : reason + ": " + words;
}

}  // namespace lf::app
