// The SDO client against servers that answer by script: byte by byte from CiA 301, 7.2.4.
#include "firmware/canopen/sdo_client.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace lf::canopen {
namespace {

using Data = std::array<std::uint8_t, 8>;

CanFrame answer(const Data& data, std::uint8_t node = 3) {
  CanFrame f;
  f.id = 0x580u + node;
  f.length = 8;
  f.data = data;
  return f;
}

class Sdo : public ::testing::Test {
 protected:
  static constexpr Duration timeout = Duration::from_ms(100);
  SdoClient client{3, timeout};
  Time now = Time::from_ns(5'000'000);

  // The frame the client sends now; fails if there is none.
  Data sent() {
    CanFrame f;
    EXPECT_TRUE(client.poll(now, f));
    EXPECT_EQ(f.id, 0x603u);
    EXPECT_EQ(f.length, 8);
    return f.data;
  }
  bool silent() {
    CanFrame f;
    return !client.poll(now, f);
  }
  bool receive(const Data& data) { return client.on_frame(answer(data), now); }
  void expect_failed(std::uint32_t code, bool by_server) {
    EXPECT_EQ(client.state(), SdoClient::State::failed);
    EXPECT_EQ(client.abort_code(), code) << sdo_abort::name(client.abort_code());
    EXPECT_EQ(client.aborted_by_server(), by_server);
  }
  static Data abort_frame(std::uint16_t index, std::uint8_t sub, std::uint32_t code) {
    return {0x80,
            static_cast<std::uint8_t>(index),
            static_cast<std::uint8_t>(index >> 8),
            sub,
            static_cast<std::uint8_t>(code),
            static_cast<std::uint8_t>(code >> 8),
            static_cast<std::uint8_t>(code >> 16),
            static_cast<std::uint8_t>(code >> 24)};
  }
};

TEST_F(Sdo, ReadsAnExpeditedValueOfEachLength) {
  const std::array<std::uint8_t, 4> commands{0x4F, 0x4B, 0x47, 0x43};
  for (std::size_t n = 1; n <= 4; ++n) {
    ASSERT_TRUE(client.upload(0x6064, 2));
    EXPECT_EQ(sent(), (Data{0x40, 0x64, 0x60, 0x02}));
    EXPECT_TRUE(receive({commands[n - 1], 0x64, 0x60, 0x02, 0x11, 0x22, 0x33, 0x44}));
    ASSERT_EQ(client.state(), SdoClient::State::done);
    EXPECT_EQ(client.value().size(), n);
    EXPECT_EQ(client.number(), 0x44332211u & (n == 4 ? 0xFFFFFFFFu : (1u << (8 * n)) - 1));
    EXPECT_TRUE(client.size_known());
  }
}

TEST_F(Sdo, GivesAllFourBytesOfAnExpeditedValueWithoutLength) {
  client.upload(0x6064, 0);
  sent();
  receive({0x42, 0x64, 0x60, 0x00, 1, 2, 3, 4});
  EXPECT_EQ(client.state(), SdoClient::State::done);
  EXPECT_FALSE(client.size_known());
  EXPECT_EQ(client.value().size(), 4u);
}

TEST_F(Sdo, WritesAnExpeditedValueOfEachLength) {
  const std::array<std::uint8_t, 4> commands{0x2F, 0x2B, 0x27, 0x23};
  const std::array<std::uint8_t, 4> bytes{0x44, 0x33, 0x22, 0x11};
  for (std::size_t n = 1; n <= 4; ++n) {
    ASSERT_TRUE(client.download(0x607A, 1, std::span(bytes.data(), n)));
    Data expected{commands[n - 1], 0x7A, 0x60, 0x01};
    for (std::size_t i = 0; i < n; ++i) expected[4 + i] = bytes[i];
    EXPECT_EQ(sent(), expected);
    EXPECT_TRUE(client.busy());
    receive({0x60, 0x7A, 0x60, 0x01});
    EXPECT_EQ(client.state(), SdoClient::State::done);
  }
}

TEST_F(Sdo, ReadsAStringInSegmentsWithAlternatingToggle) {
  client.upload(0x1008, 0);
  EXPECT_EQ(sent(), (Data{0x40, 0x08, 0x10, 0x00}));
  receive({0x41, 0x08, 0x10, 0x00, 16, 0, 0, 0});
  EXPECT_EQ(sent(), (Data{0x60}));
  receive({0x00, 'L', 'a', 'n', 't', 'e', 'r', 'n'});
  EXPECT_EQ(sent(), (Data{0x70}));
  receive({0x10, 'f', 'i', 's', 'h', ' ', 'd', 'r'});
  EXPECT_EQ(sent(), (Data{0x60}));
  receive({0x0B, 'i', 'v', 0, 0, 0, 0, 0});
  ASSERT_EQ(client.state(), SdoClient::State::done);
  EXPECT_EQ(std::string(client.value().begin(), client.value().end()), "Lanternfish driv");
}

TEST_F(Sdo, WritesALongValueInSegmentsWithAlternatingToggle) {
  const std::string text = "ten bytes!";
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  ASSERT_TRUE(client.download(0x2000, 5, bytes));
  EXPECT_EQ(sent(), (Data{0x21, 0x00, 0x20, 0x05, 10, 0, 0, 0}));
  receive({0x60, 0x00, 0x20, 0x05});
  EXPECT_EQ(sent(), (Data{0x00, 't', 'e', 'n', ' ', 'b', 'y', 't'}));
  receive({0x20});
  EXPECT_EQ(sent(), (Data{0x19, 'e', 's', '!'}));
  EXPECT_TRUE(client.busy());
  receive({0x30});
  EXPECT_EQ(client.state(), SdoClient::State::done);
}

// Brings the client to each stage in which it waits for the server.
const std::array<std::pair<const char*, std::function<void(SdoClient&, Time)>>, 4>& stages() {
  static const std::vector<std::uint8_t> ten(10, 0x5A);
  static const auto drain = [](SdoClient& c, Time t) {
    CanFrame f;
    while (c.poll(t, f)) {
    }
  };
  static const std::array<std::pair<const char*, std::function<void(SdoClient&, Time)>>, 4> all{{
      {"upload",
       [](SdoClient& c, Time t) {
         c.upload(0x2000, 5);
         drain(c, t);
       }},
      {"upload segment",
       [](SdoClient& c, Time t) {
         c.upload(0x2000, 5);
         drain(c, t);
         c.on_frame(answer({0x41, 0x00, 0x20, 0x05, 20, 0, 0, 0}), t);
         drain(c, t);
       }},
      {"download",
       [](SdoClient& c, Time t) {
         c.download(0x2000, 5, 7, 2);
         drain(c, t);
       }},
      {"download segment",
       [](SdoClient& c, Time t) {
         c.download(0x2000, 5, ten);
         drain(c, t);
         c.on_frame(answer({0x60, 0x00, 0x20, 0x05}), t);
         drain(c, t);
       }},
  }};
  return all;
}

TEST_F(Sdo, EveryAbortCodeOfTheServerEndsEveryKindOfTransferUnderItsName) {
  for (const auto& [stage, reach] : stages()) {
    for (const sdo_abort::Entry& entry : sdo_abort::table) {
      SCOPED_TRACE(std::string(stage) + ": " + entry.name);
      client = SdoClient(3, timeout);
      reach(client, now);
      ASSERT_TRUE(client.busy());
      EXPECT_TRUE(receive(abort_frame(0x2000, 5, entry.code)));
      expect_failed(entry.code, true);
      EXPECT_STREQ(sdo_abort::name(client.abort_code()), entry.name);
      EXPECT_TRUE(silent()) << "an abort is not answered";
      EXPECT_EQ(client.stats().server_aborts, 1u);
    }
  }
  EXPECT_STREQ(sdo_abort::name(0x12345678), "unknown abort code");
}

TEST_F(Sdo, TheAbortCodesAreThoseOfTheStandard) {
  // CiA 301, table 22, by hand; names are ours.
  const std::vector<std::uint32_t> standard{0x05030000, 0x05040000, 0x05040001, 0x05040002, 0x05040003, 0x05040004, 0x05040005, 0x06010000,
                                            0x06010001, 0x06010002, 0x06020000, 0x06040041, 0x06040042, 0x06040043, 0x06040047, 0x06060000,
                                            0x06070010, 0x06070012, 0x06070013, 0x06090011, 0x06090030, 0x06090031, 0x06090032, 0x06090036,
                                            0x060A0023, 0x08000000, 0x08000020, 0x08000021, 0x08000022, 0x08000023, 0x08000024};
  ASSERT_EQ(standard.size(), sdo_abort::table.size());
  for (std::size_t i = 0; i < standard.size(); ++i) EXPECT_EQ(sdo_abort::table[i].code, standard[i]);
}

TEST_F(Sdo, ALateAnswerAtAnyStageIsAbortedWithATimeOut) {
  for (const auto& [stage, reach] : stages()) {
    SCOPED_TRACE(stage);
    client = SdoClient(3, timeout);
    reach(client, now);
    const Time start = now;
    now = start + timeout - Duration::from_ns(1);
    EXPECT_TRUE(silent());
    EXPECT_TRUE(client.busy());
    now = start + timeout;
    EXPECT_EQ(sent(), abort_frame(0x2000, 5, 0x05040000));
    expect_failed(0x05040000, false);
    EXPECT_TRUE(silent());
    EXPECT_EQ(client.stats().timeouts, 1u);
    EXPECT_EQ(client.stats().own_aborts, 1u);
  }
}

TEST_F(Sdo, AnAbortStillLeavesWhenTheNextTransferIsAskedForAtOnce) {
  client.upload(0x2000, 5);
  sent();
  now = now + timeout;
  CanFrame ignored;
  Data first = sent();
  EXPECT_EQ(first, abort_frame(0x2000, 5, 0x05040000));
  client.upload(0x2000, 5);
  sent();
  receive({0x60, 0x00, 0x20, 0x05});  // the wrong kind of answer: our own abort is due
  ASSERT_EQ(client.state(), SdoClient::State::failed);
  ASSERT_TRUE(client.upload(0x3000, 1));
  EXPECT_EQ(sent(), abort_frame(0x2000, 5, 0x05040001));
  EXPECT_EQ(sent(), (Data{0x40, 0x00, 0x30, 0x01}));
  EXPECT_FALSE(client.poll(now, ignored));
}

TEST_F(Sdo, AWrongToggleIsAbortedOnUploadAndOnDownload) {
  client.upload(0x1008, 0);
  sent();
  receive({0x41, 0x08, 0x10, 0x00, 14, 0, 0, 0});
  sent();
  receive({0x10, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(sent(), abort_frame(0x1008, 0, 0x05030000));
  expect_failed(0x05030000, false);

  stages()[3].second(client, now);
  receive({0x30});
  EXPECT_EQ(sent(), abort_frame(0x2000, 5, 0x05030000));
  expect_failed(0x05030000, false);
}

TEST_F(Sdo, ARepeatedSegmentIsAbortedByItsToggle) {
  client.upload(0x1008, 0);
  sent();
  receive({0x41, 0x08, 0x10, 0x00, 20, 0, 0, 0});
  sent();
  receive({0x00, 1, 2, 3, 4, 5, 6, 7});
  sent();
  receive({0x00, 1, 2, 3, 4, 5, 6, 7});
  expect_failed(0x05030000, false);
}

TEST_F(Sdo, AnAnswerOfTheWrongKindIsAbortedAsUnknownCommand) {
  const std::array<std::uint8_t, 4> wrong{0x60, 0x20, 0x40, 0x00};  // for each stage, an answer that belongs to another
  for (std::size_t i = 0; i < stages().size(); ++i) {
    SCOPED_TRACE(stages()[i].first);
    client = SdoClient(3, timeout);
    stages()[i].second(client, now);
    receive({wrong[i], 0x00, 0x20, 0x05});
    EXPECT_EQ(sent(), abort_frame(0x2000, 5, 0x05040001));
    expect_failed(0x05040001, false);
  }
}

TEST_F(Sdo, AnAnswerAboutAnotherObjectIsRefusedAndTheWaitGoesOn) {
  client.upload(0x6064, 0);
  sent();
  EXPECT_FALSE(receive({0x43, 0x65, 0x60, 0x00, 1}));
  EXPECT_FALSE(receive({0x43, 0x64, 0x60, 0x01, 1}));
  EXPECT_FALSE(receive(abort_frame(0x6063, 0, 0x06020000)));
  EXPECT_TRUE(client.busy());
  EXPECT_EQ(client.stats().wrong_object, 3u);
  EXPECT_TRUE(receive({0x43, 0x64, 0x60, 0x00, 9}));
  EXPECT_EQ(client.number(), 9u);
}

TEST_F(Sdo, WrongAnswersDoNotProlongTheWait) {
  client.upload(0x6064, 0);
  sent();
  const Time start = now;
  for (int i = 0; i < 50; ++i) {
    now = now + Duration::from_ms(1);
    receive({0x43, 0x65, 0x60, 0x00, 1});
  }
  now = start + timeout;
  EXPECT_EQ(sent(), abort_frame(0x6064, 0, 0x05040000));
}

TEST_F(Sdo, AnswersWhileIdleOrBeforeTheRequestLeftAreRefused) {
  EXPECT_FALSE(receive({0x43, 0x64, 0x60, 0x00, 1}));
  client.upload(0x6064, 0);
  EXPECT_FALSE(receive({0x43, 0x64, 0x60, 0x00, 1}));
  EXPECT_EQ(client.stats().unexpected, 2u);
  EXPECT_TRUE(client.busy());
}

TEST_F(Sdo, AValueLongerThanTheBufferIsAbortedWhetherAnnouncedOrNot) {
  client.upload(0x1008, 0);
  sent();
  receive({0x41, 0x08, 0x10, 0x00, SdoClient::capacity + 1, 0, 0, 0});
  expect_failed(0x05040005, false);

  client = SdoClient(3, timeout);
  client.upload(0x1008, 0);
  sent();
  receive({0x40, 0x08, 0x10, 0x00});
  int segments = 0;
  while (client.busy() && segments < 100) {
    const bool toggle = sent()[0] == 0x70;
    receive({static_cast<std::uint8_t>(toggle ? 0x10 : 0x00), 1, 2, 3, 4, 5, 6, 7});
    ++segments;
  }
  expect_failed(0x05040005, false);
  EXPECT_EQ(segments, static_cast<int>(SdoClient::capacity / 7) + 1);
}

TEST_F(Sdo, AnAnnouncedLengthThatIsNotKeptIsAborted) {
  client.upload(0x1008, 0);
  sent();
  receive({0x41, 0x08, 0x10, 0x00, 9, 0, 0, 0});
  sent();
  receive({0x01, 1, 2, 3, 4, 5, 6, 7});  // last one after 7 of 9 bytes
  EXPECT_EQ(sent(), abort_frame(0x1008, 0, 0x06070010));

  client.upload(0x1008, 0);
  sent();
  receive({0x41, 0x08, 0x10, 0x00, 5, 0, 0, 0});
  sent();
  receive({0x00, 1, 2, 3, 4, 5, 6, 7});  // 7 of 5 bytes
  EXPECT_EQ(sent(), abort_frame(0x1008, 0, 0x06070012));
}

TEST_F(Sdo, EmptySegmentsWithoutEndAreAborted) {
  client.upload(0x1008, 0);
  sent();
  receive({0x40, 0x08, 0x10, 0x00});
  sent();
  receive({0x0E, 0, 0, 0, 0, 0, 0, 0});
  expect_failed(0x06070010, false);
}

TEST_F(Sdo, RefusesToStartWhileBusyOrWithAnImpossibleValue) {
  const std::vector<std::uint8_t> big(SdoClient::capacity + 1);
  EXPECT_FALSE(client.download(0x2000, 0, big));
  EXPECT_FALSE(client.download(0x2000, 0, std::span<const std::uint8_t>()));
  EXPECT_FALSE(client.download(0x2000, 0, 1, 5));
  ASSERT_TRUE(client.upload(0x2000, 0));
  EXPECT_FALSE(client.upload(0x2000, 1));
  EXPECT_FALSE(client.download(0x2000, 1, 1, 4));
  EXPECT_EQ(sent(), (Data{0x40, 0x00, 0x20, 0x00}));
}

}  // namespace
}  // namespace lf::canopen
