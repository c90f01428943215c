#include "host_sim/app/lost_run.hpp"

#include <gtest/gtest.h>

namespace lf::app {
namespace {

constexpr int exited(int status) { return status << 8; }  // as waitpid() has it

TEST(LostRun, SaysHowItEnded) {
  EXPECT_EQ(lost_reason(11, "", ""), "ended by signal 11");
  EXPECT_EQ(lost_reason(9, "a last word", "x was 1, is 2"), "ended by signal 9: a last word");
  EXPECT_EQ(lost_reason(exited(2), "lanternfish: no such file", ""), "refused: lanternfish: no such file");
  EXPECT_EQ(lost_reason(exited(2), "lanternfish: holds another", "x was 1, is 2"), "refused: lanternfish: holds another");
  EXPECT_EQ(lost_reason(exited(127), "", ""), "exit status 127");
  EXPECT_EQ(lost_reason(exited(1), "", ""), "exit status 1");
}

// A program that was built anew, or a file that was edited, while the campaign flew.
TEST(LostRun, ThatFlewAnotherExperimentSaysWhatChanged) {
  EXPECT_EQ(lost_reason(exited(0), "", "program is another"), "something changed since the campaign began: program is another");
  EXPECT_EQ(lost_reason(exited(1), "", "x was 1, is 2"), "something changed since the campaign began: x was 1, is 2");
}

}  // namespace
}  // namespace lf::app
