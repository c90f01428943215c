// Real time that this machine does not grant: the process goes on, and says what it has lost.
#include "hal/vehicle/realtime.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <sstream>
#include <string>
#include <vector>

namespace lf::hal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr unsigned nobody = 65534;
constexpr const char* still_has_rights = "still has its rights";

// What a process without any rights is told; run in a child, since rights do not come back.
std::vector<std::string> lost_without_rights(const RealtimeConfig& config) {
  std::array<int, 2> ends{};
  EXPECT_EQ(pipe(ends.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    const rlimit none{0, 0};
    const bool poor =
        setrlimit(RLIMIT_RTPRIO, &none) == 0 && setrlimit(RLIMIT_MEMLOCK, &none) == 0 && (geteuid() != 0 || setuid(nobody) == 0);
    std::string text = poor ? "" : std::string(still_has_rights) + "\n";
    for (const std::string& line : lock_process_memory(config)) text += line + "\n";
    for (const std::string& line : become_realtime(config)) text += line + "\n";
    const bool told = write(ends[1], text.data(), text.size()) == static_cast<ssize_t>(text.size());
    _exit(told ? 0 : 1);
  }
  close(ends[1]);
  std::string text;
  std::array<char, 1024> buffer{};
  for (ssize_t bytes = 1; bytes > 0;) {
    bytes = read(ends[0], buffer.data(), buffer.size());
    if (bytes > 0) text.append(buffer.data(), static_cast<std::size_t>(bytes));
  }
  close(ends[0]);
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "it did not go on: " << status;
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(RealTime, ThatIsRefusedIsSaidAndWhatToDoAboutIt) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer's mlockall does nothing, and says that it did";
#endif
  RealtimeConfig config;
  config.priority = 80;
  config.cpu = -1;
  config.lock_memory = true;
  const std::vector<std::string> lost = lost_without_rights(config);
  if (!lost.empty() && lost.front() == still_has_rights) GTEST_SKIP() << "this user cannot become nobody";
  EXPECT_THAT(lost, ElementsAre(testing::AllOf(HasSubstr("memory is not locked"), HasSubstr("CAP_IPC_LOCK")),
                                testing::AllOf(HasSubstr("not SCHED_FIFO"), HasSubstr("CAP_SYS_NICE or LimitRTPRIO=80"))));
}

TEST(RealTime, OnAProcessorThatIsNotThereIsRefused) {
  RealtimeConfig config;
  config.priority = 0;
  config.cpu = 1023;
  config.lock_memory = false;
  EXPECT_THAT(lost_without_rights(config), ElementsAre(HasSubstr("not tied to CPU 1023")));
}

TEST(RealTime, ThatIsNotAskedForIsNotMissed) {
  RealtimeConfig config;
  config.priority = 0;
  config.cpu = -1;
  config.lock_memory = false;
  EXPECT_THAT(lost_without_rights(config), testing::IsEmpty());
}

}  // namespace
}  // namespace lf::hal
