// The EDS files against the simulated devices themselves, asked over SDO: same objects, types, access, defaults, limits, mappings. Nothing more, nothing less.
#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "host_sim/devices/drive/drive402.hpp"
#include "host_sim/devices/io_node.hpp"
#include "shared/arm/arm_description.hpp"
#include "tests/unit/can_map/eds_file.hpp"
#include "tests/unit/devices/canopen/client.hpp"

namespace lf::test {
namespace {

using devices::test::Client;

constexpr std::uint32_t abort_read_only = 0x06010002, abort_no_object = 0x06020000, abort_not_mappable = 0x06040041,
                        abort_no_sub_index = 0x06090011, abort_too_high = 0x06090031, abort_too_low = 0x06090032;

struct Sheet {
  const char* file;
  int node;
};
const Sheet sheets[] = {{"node1_slew.eds", 1}, {"node2_shoulder.eds", 2}, {"node3_elbow.eds", 3},
                        {"node4_roll.eds", 4}, {"node5_jaw.eds", 5},      {"node6_outputs.eds", 6}};

// A freshly booted device in pre-operational state, as devices::Devices makes it.
class Device {
 public:
  explicit Device(int number) {
    const ArmDescription arm = load_arm_urdf(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf");
    devices::DevicesConfig config = devices::devices_config(arm, {}, 1);
    const Duration boot = Duration::from_ms(2);
    if (number == can_map::io_node) {
      io_ = std::make_unique<devices::IoNode>(config.io, boot);
      io_->power_on({});
      for (int ms = 1; ms < 5; ++ms) io_->tick(Time::from_ns(ms * 1'000'000));
    } else {
      drive_ = std::make_unique<devices::Drive402>(config.drives[static_cast<std::size_t>(number - 1)], boot, 1);
      drive_->power_on({}, {});
      for (int ms = 1; ms < 5; ++ms) drive_->tick(Time::from_ns(ms * 1'000'000), {});
    }
    client = std::make_unique<Client>(io_ ? io_->node() : drive_->node());
    client->now = Time::from_ns(5'000'000);
  }

  std::unique_ptr<Client> client;

 private:
  std::unique_ptr<devices::Drive402> drive_;
  std::unique_ptr<devices::IoNode> io_;
};

std::int64_t value_of(const CanFrame& answer, const EdsEntry& entry) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < entry.bytes(); ++i) bits |= std::uint64_t{answer.data[4 + i]} << (8 * i);
  const unsigned unused = static_cast<unsigned>(64 - 8 * entry.bytes());
  return entry.is_signed() ? static_cast<std::int64_t>(bits << unused) >> unused : static_cast<std::int64_t>(bits);
}

// The text of an upload that was answered with `answer`: in it, or in the segments that follow.
std::string text_of(Client& client, CanFrame answer) {
  if ((answer.data[0] & 0x02) != 0) {
    return {answer.data.begin() + 4, answer.data.begin() + 4 + (4 - ((answer.data[0] >> 2) & 3))};
  }
  std::string text;
  for (std::uint8_t toggle = 0; text.size() < 256; toggle ^= 0x10) {
    answer = client.sdo({static_cast<std::uint8_t>(0x60 | toggle), 0, 0, 0, 0, 0, 0, 0});
    if (answer.length != 8 || (answer.data[0] & 0xF0) != toggle) return "no segment";
    const std::size_t bytes = 7u - ((answer.data[0] >> 1) & 7u);
    text.append(answer.data.begin() + 1, answer.data.begin() + 1 + static_cast<std::ptrdiff_t>(bytes));
    if ((answer.data[0] & 1) != 0) break;
  }
  return text;
}

class EdsTest : public testing::TestWithParam<Sheet> {
 protected:
  void each(const std::function<void(std::uint16_t, std::uint8_t, const EdsEntry&)>& check) {
    for (const auto& [key, entry] : eds.entries()) {
      SCOPED_TRACE(testing::Message() << std::hex << (key >> 8) << ":" << (key & 0xFF) << " " << entry.name);
      check(static_cast<std::uint16_t>(key >> 8), static_cast<std::uint8_t>(key & 0xFF), entry);
    }
  }
  CanFrame upload(std::uint16_t index, std::uint8_t sub) {
    return device.client->sdo({0x40, static_cast<std::uint8_t>(index & 0xFF), static_cast<std::uint8_t>(index >> 8), sub, 0, 0, 0, 0});
  }

  EdsFile eds{std::string(LANTERNFISH_CAN_FILES "/") + GetParam().file};
  Device device{GetParam().node};
};

TEST_P(EdsTest, the_sheet_is_one_that_cia_306_allows) {
  EXPECT_TRUE(eds.complaints().empty()) << testing::PrintToString(eds.complaints());
  EXPECT_GT(eds.entries().size(), 100u);
}

TEST_P(EdsTest, every_object_of_the_sheet_answers_with_its_type_and_default) {
  std::size_t compared = 0;
  each([&](std::uint16_t index, std::uint8_t sub, const EdsEntry& entry) {
    const CanFrame answer = upload(index, sub);
    if (index == 0x1003 && sub > 0) {  // no errors yet: the history's entries are there when it has them
      EXPECT_EQ(Client::u32(answer, 4), abort_no_sub_index);
      return;
    }
    ASSERT_NE(answer.data[0], 0x80) << std::hex << Client::u32(answer, 4);
    if (entry.text()) {
      EXPECT_EQ(text_of(*device.client, answer), entry.value);
      ++compared;
      return;
    }
    ASSERT_EQ(answer.data[0], 0x43 | ((4 - entry.bytes()) << 2));
    const bool measured = entry.access == "ro" && entry.mappable;  // a present value, not a default
    if (measured) return;
    EXPECT_EQ(value_of(answer, entry), EdsFile::number(entry.value, GetParam().node));
    ++compared;
  });
  EXPECT_GT(compared, 80u);
}

TEST_P(EdsTest, the_device_has_no_object_that_the_sheet_has_not) {
  for (std::uint32_t index = 0x1000; index <= 0xFFFF; ++index) {
    const bool listed = eds.entries().count(index << 8) != 0;
    for (std::uint32_t sub = 0; sub < (listed ? 256u : 1u); ++sub) {
      if (eds.entries().count((index << 8) | sub) != 0) continue;
      const CanFrame answer = upload(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub));
      ASSERT_EQ(answer.data[0], 0x80) << std::hex << index << ":" << sub;
      EXPECT_EQ(Client::u32(answer, 4), listed ? abort_no_sub_index : abort_no_object) << std::hex << index << ":" << sub;
    }
  }
}

TEST_P(EdsTest, what_the_sheet_calls_constant_or_read_only_cannot_be_written) {
  each([&](std::uint16_t index, std::uint8_t sub, const EdsEntry& entry) {
    if (entry.access != "ro" && entry.access != "const") return;
    EXPECT_EQ(device.client->write(index, sub, 0, entry.text() ? 4 : entry.bytes()), abort_read_only);
  });
}

TEST_P(EdsTest, limits_hold_to_the_last_number) {
  each([&](std::uint16_t index, std::uint8_t sub, const EdsEntry& entry) {
    if (entry.access[0] != 'r' || entry.access == "ro") return;
    const int bits = static_cast<int>(8 * entry.bytes());
    const std::int64_t type_low = entry.is_signed() ? -(std::int64_t{1} << (bits - 1)) : 0;
    const std::int64_t type_high = (std::int64_t{1} << (entry.is_signed() ? bits - 1 : bits)) - 1;
    if (entry.has_high && entry.high < type_high) {
      EXPECT_EQ(device.client->write(index, sub, entry.high + 1, entry.bytes()), abort_too_high);
    }
    if (entry.has_low && entry.low > type_low) {
      EXPECT_EQ(device.client->write(index, sub, entry.low - 1, entry.bytes()), abort_too_low);
    }
  });
}

TEST_P(EdsTest, mapping_is_allowed_where_the_sheet_says_so) {
  for (const std::uint16_t base : {0x1400, 0x1800}) {
    Client& client = *device.client;
    const bool transmit = base == 0x1800;
    ASSERT_EQ(client.write(base, 1, 0x80000000u, 4), 0u);
    ASSERT_EQ(client.write(static_cast<std::uint16_t>(base + 0x200), 0, 0, 1), 0u);
    each([&](std::uint16_t index, std::uint8_t sub, const EdsEntry& entry) {
      const auto what = static_cast<std::int64_t>((std::uint32_t{index} << 16) | (std::uint32_t{sub} << 8) | (8 * entry.bytes()));
      const bool allowed = entry.mappable && (transmit ? entry.access == "ro" || entry.access == "rw" || entry.access == "rwr"
                                                       : entry.access == "rw" || entry.access == "rww");
      EXPECT_EQ(client.write(static_cast<std::uint16_t>(base + 0x200), 1, what, 4), allowed ? 0 : abort_not_mappable);
    });
    for (std::uint16_t dummy = 2; dummy <= 7; ++dummy) {  // [DummyUsage]: may fill a received PDO
      const std::int64_t dummy_bits[] = {0, 0, 8, 16, 32, 8, 16, 32};
      EXPECT_EQ(eds.value("DummyUsage", "Dummy000" + std::to_string(dummy)), "1");
      const std::int64_t what = (std::int64_t{dummy} << 16) | dummy_bits[dummy];
      EXPECT_EQ(client.write(static_cast<std::uint16_t>(base + 0x200), 1, what, 4), transmit ? abort_not_mappable : 0u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Nodes, EdsTest, testing::ValuesIn(sheets),
                         [](const testing::TestParamInfo<Sheet>& i) { return "node" + std::to_string(i.param.node); });

}  // namespace
}  // namespace lf::test
