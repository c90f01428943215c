// The doctor's look at real time and clocks, in folders that stand for /proc and /sys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "hal/vehicle/doctor/examination.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "tests/unit/vehicle/fake_linux.hpp"

namespace lf::hal::doctor {
namespace {

using testing::HasSubstr;

class RealtimeExamination : public testing::Test {
 protected:
  // A desk's: nothing is permitted, Debian's kernel, four processors.
  RealtimeExamination() {
    write("proc/self/limits",
          "Limit                     Soft Limit           Hard Limit           Units     \n"
          "Max locked memory         8388608              8388608              bytes     \n"
          "Max realtime priority     0                    0                    \n"
          "Max realtime timeout      unlimited            unlimited            us        \n");
    write("proc/self/status", "Name:\tlanternfishd\nCapPrm:\t000001ffffffffff\nCapEff:\t0000000000000000\n");
    write("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
    write("proc/sys/kernel/sched_rt_period_us", "1000000\n");
    write("proc/version",
          "Linux version 6.1.0-18-amd64 (debian-kernel@lists.debian.org) #1 SMP PREEMPT_DYNAMIC Debian 6.1.76-1 (2024-02-01)\n");
    write("proc/cmdline", "BOOT_IMAGE=/boot/vmlinuz-6.1.0-18-amd64 root=/dev/sda1 ro quiet\n");
    write("sys/devices/system/cpu/online", "0-3\n");
    write("sys/devices/system/cpu/isolated", "\n");
    write("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n");
  }
  void write(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories((folder.path() / file).parent_path());
    std::ofstream(folder.path() / file) << text;
  }
  Examination look(const std::string& subject) {
    Machine machine{folder.path() / "proc", folder.path() / "sys", &kernel};
    Examinations found;
    examine_realtime(config, machine, found);
    examine_clock(config, machine, found);
    for (const Examination& one : found) {
      if (one.grade != Grade::good) {
        EXPECT_FALSE(one.remedy.empty()) << one.subject;
      }
      if (one.subject == subject) return one;
    }
    return {subject, "", Grade::good, "nothing", ""};
  }

  const test::TemporaryFolder folder;
  test::FakeLinux kernel;
  VehicleConfig config;
};

TEST_F(RealtimeExamination, WhatAUserMayNotIsBad) {
  EXPECT_EQ(look("priority").found, "this user may not have priority 80 (its limit is 0)");
  EXPECT_THAT(look("priority").remedy, HasSubstr("LimitRTPRIO"));
  EXPECT_EQ(look("locked memory").found, "this user may not lock all memory (its limit is 8388608 bytes)");
  config.realtime.priority = 0;
  config.realtime.lock_memory = false;
  EXPECT_EQ(look("priority").grade, Grade::note);
  EXPECT_EQ(look("locked memory").grade, Grade::note);
}

// As the unit grants it: by limits, or by capabilities.
TEST_F(RealtimeExamination, EitherLimitOrCapabilityPermits) {
  write("proc/self/limits",
        "Max locked memory         unlimited            unlimited            bytes     \n"
        "Max realtime priority     90                   90                   \n");
  EXPECT_EQ(look("priority").grade, Grade::good);
  EXPECT_EQ(look("locked memory").grade, Grade::good);
  config.realtime.priority = 91;
  EXPECT_EQ(look("priority").grade, Grade::bad);
  config.realtime.priority = 80;
  write("proc/self/limits", "");
  EXPECT_EQ(look("priority").grade, Grade::bad);
  write("proc/self/status", "CapEff:\t0000000000800000\n");  // CAP_SYS_NICE, bit 23
  EXPECT_EQ(look("priority").grade, Grade::good);
  EXPECT_EQ(look("locked memory").grade, Grade::bad);
  write("proc/self/status", "CapEff:\t0000000000004000\n");  // CAP_IPC_LOCK, bit 14
  EXPECT_EQ(look("locked memory").grade, Grade::good);
  EXPECT_EQ(look("priority").grade, Grade::bad);
}

// This process's own, against getrlimit(2).
TEST_F(RealtimeExamination, LimitsAreThoseOfThisProcess) {
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_RTPRIO, &limit), 0);
  write("proc/self/status", "");
  std::ostringstream own;
  own << std::ifstream("/proc/self/limits").rdbuf();
  write("proc/self/limits", own.str());
  const bool may = limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur >= 80;
  EXPECT_EQ(look("priority").grade, may ? Grade::good : Grade::bad);
  if (!may) {
    EXPECT_THAT(look("priority").found, HasSubstr("(its limit is " + std::to_string(limit.rlim_cur) + ")"));
  }
}

TEST_F(RealtimeExamination, AKernelThatTakesTheTimeAwayIsBad) {
  EXPECT_EQ(look("throttling").found, "950000 us of every 1000000 us are for real-time threads");
  write("proc/sys/kernel/sched_rt_runtime_us", "-1\n");
  EXPECT_EQ(look("throttling").grade, Grade::good);
  write("proc/sys/kernel/sched_rt_runtime_us", "50000\n");
  EXPECT_EQ(look("throttling").grade, Grade::bad);
  write("proc/sys/kernel/sched_rt_runtime_us", "0\n");
  EXPECT_EQ(look("throttling").remedy, "`sysctl kernel.sched_rt_runtime_us=950000`");
  write("proc/sys/kernel/sched_rt_runtime_us", "many\n");
  EXPECT_EQ(look("throttling").found, "nothing");
}

TEST_F(RealtimeExamination, TheKernelsPreemption) {
  EXPECT_EQ(look("kernel").grade, Grade::note);
  EXPECT_THAT(look("kernel").remedy, HasSubstr("preempt=full"));
  write("proc/cmdline", "root=/dev/sda1 preempt=full quiet\n");
  EXPECT_EQ(look("kernel").grade, Grade::good);
  write("proc/cmdline", "root=/dev/sda1 preempt=fullest\n");
  EXPECT_EQ(look("kernel").grade, Grade::note);
  write("proc/version", "Linux version 6.1.0-18-rt-amd64 #1 SMP PREEMPT_RT Debian 6.1.76-1\n");
  EXPECT_THAT(look("kernel").found, HasSubstr("real-time"));
}

TEST_F(RealtimeExamination, ProcessorsThatAreThereAndIsolated) {
  config.realtime.cpu = 3;
  EXPECT_EQ(look("processor").grade, Grade::note);
  EXPECT_THAT(look("processor").remedy, HasSubstr("isolcpus=3"));
  write("sys/devices/system/cpu/isolated", "1,3\n");
  EXPECT_EQ(look("processor").grade, Grade::good);
  write("sys/devices/system/cpu/online", "0,2-3\n");
  config.realtime.cpu = 1;
  EXPECT_EQ(look("processor").found, "there is no processor 1");
  EXPECT_EQ(look("processor").remedy, "this machine has 0,2-3");
  config.vision_cpu = 4;
  EXPECT_EQ(look("vision's processor").grade, Grade::bad);
  config.vision_cpu = 2;
  EXPECT_EQ(look("vision's processor").grade, Grade::good) << "vision shares its processor";
}

TEST_F(RealtimeExamination, Clocks) {
  EXPECT_EQ(look("clock").found, "steps of 1 ns, from tsc");
  EXPECT_EQ(look("wall clock").grade, Grade::good);
  kernel.monotonic_step = 4'000'000;
  EXPECT_EQ(look("clock").grade, Grade::bad);
  kernel.monotonic_step = 1;
  write("sys/devices/system/clocksource/clocksource0/current_clocksource", "jiffies\n");
  EXPECT_EQ(look("clock").grade, Grade::bad);
  kernel.wall_clock_kept = false;
  EXPECT_EQ(look("wall clock").grade, Grade::note) << "the arm does not need it";
}

// A container has neither /proc nor /sys of its own: nothing is known, and nothing is claimed.
TEST_F(RealtimeExamination, AMachineThatShowsNothing) {
  std::filesystem::remove_all(folder.path() / "proc");
  std::filesystem::remove_all(folder.path() / "sys");
  EXPECT_EQ(look("priority").grade, Grade::bad);
  EXPECT_THAT(look("priority").found, HasSubstr("its limit is unknown"));
  EXPECT_EQ(look("kernel").found, "nothing");
  EXPECT_EQ(look("throttling").found, "nothing");
}

}  // namespace
}  // namespace lf::hal::doctor
