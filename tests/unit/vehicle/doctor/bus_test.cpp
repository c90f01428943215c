// The doctor's look at the CAN interface: a kernel's answers, right ones and cut ones, and what it makes of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "hal/vehicle/doctor/can_link.hpp"
#include "hal/vehicle/doctor/examination.hpp"
#include "shared/can/can_map.hpp"
#include "tests/unit/vehicle/doctor/link_message.hpp"
#include "tests/unit/vehicle/fake_linux.hpp"

namespace lf::hal::doctor {
namespace {

using test::Bytes;
using test::FakeLinux;
using test::Link;
using test::link_message;
using testing::HasSubstr;

TEST(CanLink, IsReadFromTheKernelsAnswer) {
  const CanLink link =
      parse_can_link(link_message({.queue = 1000, .bit_rate = 500'000, .sample_point = 800, .restart_ms = 100, .state = 2}));
  EXPECT_EQ(link.error, 0);
  EXPECT_TRUE(link.is_can);
  EXPECT_TRUE(link.up);
  EXPECT_EQ(link.kind, "can");
  EXPECT_EQ(link.queue, 1000u);
  EXPECT_EQ(link.bit_rate, 500'000u);
  EXPECT_DOUBLE_EQ(link.sample_point, 0.8);
  EXPECT_EQ(link.restart_ms, 100u);
  EXPECT_EQ(link.state, 2u);
  const CanLink virtual_one = parse_can_link(link_message({.flags = 0, .kind = "vcan"}));
  EXPECT_FALSE(virtual_one.up);
  EXPECT_EQ(virtual_one.kind, "vcan");
  EXPECT_FALSE(virtual_one.bit_rate);
  EXPECT_EQ(parse_can_link(test::error_message(ENODEV)).error, ENODEV);
}

// Bytes of others: whatever is cut or changed is an answer without the rest, and never read past its end (the sanitized build looks).
TEST(CanLink, AnAnswerCutAnywhereIsNoCrash) {
  const Bytes whole = link_message({});
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    const std::vector<char> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(bytes));
    EXPECT_EQ(parse_can_link(cut).error, EPROTO) << bytes;
    for (const char change : {'\0', '\x01', '\xFF'}) {
      Bytes changed = whole;
      changed[bytes] = change;
      (void)parse_can_link(changed);
    }
  }
}

// The kernel that runs this test.
TEST(CanLink, IsAskedOfTheRealKernel) {
  EXPECT_EQ(read_can_link("can99", linux_calls()).error, ENODEV);
  const CanLink loopback = read_can_link("lo", linux_calls());
  ASSERT_EQ(loopback.error, 0);
  EXPECT_FALSE(loopback.is_can);
  EXPECT_EQ(std::to_string(loopback.queue), first_line("/sys/class/net/lo/tx_queue_len"));
  // The flags in hex, 1 is IFF_UP.
  EXPECT_EQ(loopback.up, std::stoul(first_line("/sys/class/net/lo/flags"), nullptr, 16) % 2 == 1);
}

class BusExamination : public testing::Test {
 protected:
  FakeLinux kernel;
  VehicleConfig config;

  Examinations look(const std::vector<char>& answer) {
    kernel.link = answer;
    Examinations found;
    Machine machine;
    machine.calls = &kernel;
    examine_bus(config, machine, found);
    EXPECT_EQ(kernel.open_sockets, 0) << "nothing stays open";
    return found;
  }
  static Examination of(const Examinations& found, const std::string& subject) {
    const auto one = std::find_if(found.begin(), found.end(), [&](const Examination& e) { return e.subject == subject; });
    return one == found.end() ? Examination{subject, "", Grade::good, "nothing", ""} : *one;
  }
  static std::vector<std::string> bad_of(const Examinations& found) {
    std::vector<std::string> names;
    for (const Examination& one : found) {
      if (one.grade == Grade::bad) names.push_back(one.subject);
      if (one.grade != Grade::good) {
        EXPECT_FALSE(one.remedy.empty()) << one.subject << " has no remedy";
      }
    }
    return names;
  }
};

TEST_F(BusExamination, AnInterfaceAsItShouldBeIsGood) {
  const Examinations found = look(link_message({.queue = 32}));
  EXPECT_THAT(bad_of(found), testing::IsEmpty());
  EXPECT_EQ(of(found, "interface").found, "can0 is up, kind can");
  EXPECT_EQ(of(found, "bit rate").found, "1000000 bit/s, sampled at 87.5 % of a bit");
  EXPECT_EQ(of(found, "transmit queue").found, "can0 queues 32 frames");
  EXPECT_THAT(of(found, "controller").found, HasSubstr("error active"));
  EXPECT_THAT(bad_of(look(link_message({.queue = 1000, .kind = "vcan"}))), testing::IsEmpty()) << "a virtual one delivers at once";
}

TEST_F(BusExamination, EachThingThatIsWrongHasItsRemedy) {
  const auto remedy = [&](const Link& link, const std::string& subject) {
    const Examinations found = look(link_message(link));
    EXPECT_THAT(bad_of(found), testing::Contains(subject));
    return of(found, subject).remedy;
  };
  EXPECT_EQ(remedy({.flags = 0}, "interface"), "`ip link set can0 up type can bitrate 1000000 restart-ms 0`");
  EXPECT_EQ(remedy({.flags = 0, .kind = "vcan"}, "interface"), "`ip link set can0 up`");
  EXPECT_THAT(remedy({.type = 1}, "interface"), HasSubstr("type can"));
  EXPECT_THAT(remedy({.bit_rate = 500'000}, "bit rate"), HasSubstr("bitrate 1000000"));
  EXPECT_THAT(remedy({.bit_rate = 0}, "bit rate"), HasSubstr("bitrate 1000000"));
  EXPECT_EQ(remedy({.queue = 1000}, "transmit queue"), "`ip link set can0 txqueuelen 32`");
  EXPECT_THAT(remedy({.restart_ms = 100}, "restart"), HasSubstr("restart-ms 0"));
  EXPECT_THAT(remedy({.state = 3}, "controller"), HasSubstr("restart-bus"));
  EXPECT_EQ(of(look(link_message({.state = 2})), "controller").grade, Grade::note) << "error passive: it still takes part";
}

TEST_F(BusExamination, AnInterfaceThatIsNotThereAndAKernelWithoutCan) {
  config.interface = "can99";
  EXPECT_EQ(of(look(test::error_message(ENODEV)), "interface").found, "there is no interface can99");
  EXPECT_THAT(of(look(test::error_message(EPERM)), "interface").found, HasSubstr("Operation not permitted"));
  EXPECT_THAT(of(look({}), "interface").found, HasSubstr("timed out"));
  kernel.has_can = false;
  EXPECT_THAT(of(look(link_message({})), "CAN sockets").remedy, HasSubstr("modprobe can_raw"));
}

TEST_F(BusExamination, TheRateIsTheMapsAndNoOther) {
  EXPECT_EQ(can_map::bitrate, 1'000'000u);
  for (const std::uint32_t rate : {125'000u, 999'999u, 1'000'001u})
    EXPECT_THAT(bad_of(look(link_message({.bit_rate = rate}))), testing::Contains("bit rate")) << rate;
}

}  // namespace
}  // namespace lf::hal::doctor
