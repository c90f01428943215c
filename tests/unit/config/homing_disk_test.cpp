// What keeps a commissioned zero through a power cut: the order in which the homing file goes to the disk. The C library's calls are this file's.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <vector>

#include "hal/config/homing_file.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace {

std::vector<std::string> calls;
std::string failing;  // the call that fails, by its name in `calls`

int told(const std::string& call, long result) {
  calls.push_back(call);
  if (call == failing) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(result);
}

}  // namespace

extern "C" int fsync(int fd) {
  struct stat status {};
  const bool folder = fstat(fd, &status) == 0 && S_ISDIR(status.st_mode);
  return told(folder ? "fsync of the folder" : "fsync of the file", syscall(SYS_fsync, fd));
}

extern "C" int rename(const char* from, const char* to) noexcept {
  return told("rename", syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

namespace lf::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class HomingDisk : public testing::Test {
 protected:
  void SetUp() override {
    calls.clear();
    failing.clear();
  }
  void write() const { config::write_homing_file(folder / "homing.yaml", config::HomingOffsets{}); }
  TemporaryFolder folder;
};

// A name that reaches the disk before its text is an empty file after a power cut.
TEST_F(HomingDisk, HasTheTextBeforeTheNameAndTheNameBeforeItIsDone) {
  write();
  EXPECT_THAT(calls, ElementsAre("fsync of the file", "rename", "fsync of the folder"));
}

TEST_F(HomingDisk, ThatFailsIsTold) {
  for (const char* call : {"fsync of the file", "rename", "fsync of the folder"}) {
    failing = call;
    EXPECT_THAT(message_of<InputError>([this] { write(); }), HasSubstr("homing.yaml: cannot be written: Input/output error")) << call;
  }
}

TEST_F(HomingDisk, ThatDoesNotTakeTheTextKeepsTheOldFile) {
  folder.write("homing.yaml", "old");
  failing = "fsync of the file";
  EXPECT_THROW(write(), InputError);
  EXPECT_EQ(folder.read("homing.yaml"), "old");
}

}  // namespace
}  // namespace lf::test
