// Every abort that a server here can raise, and both segmented directions, byte by byte (CiA 301, 7.2.4.3).
#include <gtest/gtest.h>

#include "tests/unit/devices/drive/drive_rig.hpp"

namespace lf::devices::test {
namespace {

TEST(Sdo, expedited_upload_gives_value_and_size) {
  DriveRig rig;
  const CanFrame answer = rig.client.sdo({0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(answer.data, (std::array<std::uint8_t, 8>{0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0x02, 0x00}));  // 1000 is 0x00020192
  const CanFrame byte = rig.client.sdo({0x40, 0x01, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(byte.data, (std::array<std::uint8_t, 8>{0x4F, 0x01, 0x10, 0x00, 0, 0, 0, 0}));
}

TEST(Sdo, a_string_uploads_in_segments_with_alternating_toggle) {
  DriveRig rig;
  const std::string expected = elbow().name;
  CanFrame answer = rig.client.sdo({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  ASSERT_EQ(answer.data[0], 0x41);
  ASSERT_EQ(Client::u32(answer, 4), expected.size());
  std::string text;
  for (int i = 0; i < 20; ++i) {
    const std::uint8_t toggle = i % 2 == 0 ? 0x00 : 0x10;
    answer = rig.client.sdo({static_cast<std::uint8_t>(0x60 | toggle), 0, 0, 0, 0, 0, 0, 0});
    ASSERT_EQ(answer.data[0] & 0xF0, toggle);
    const std::size_t bytes = 7u - ((answer.data[0] >> 1) & 7u);
    text.append(answer.data.begin() + 1, answer.data.begin() + 1 + static_cast<std::ptrdiff_t>(bytes));
    if ((answer.data[0] & 1) != 0) break;
  }
  EXPECT_EQ(text, expected);
}

TEST(Sdo, a_string_downloads_in_segments_and_reads_back) {
  DriveRig rig;
  EXPECT_EQ(rig.client.sdo({0x21, 0x00, 0x20, 0x00, 10, 0, 0, 0}).data[0], 0x60);
  EXPECT_EQ(rig.client.sdo({0x00, 'e', 'l', 'b', 'o', 'w', ' ', 's'}).data[0], 0x20);
  EXPECT_EQ(rig.client.sdo({0x19, 'i', 'd', 'e', 0, 0, 0, 0}).data[0], 0x30);  // toggle, 4 bytes unused, last
  EXPECT_EQ(rig.client.sdo({0x40, 0x00, 0x20, 0x00, 0, 0, 0, 0}).data[4], 10);
  const CanFrame first = rig.client.sdo({0x60, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(std::string(first.data.begin() + 1, first.data.end()), "elbow s");
}

TEST(Sdo, a_small_object_may_come_in_one_segment) {
  DriveRig rig;
  EXPECT_EQ(rig.client.sdo({0x21, 0x66, 0x60, 0x00, 2, 0, 0, 0}).data[0], 0x60);
  EXPECT_EQ(rig.client.sdo({0x0B, 0x34, 0x12, 0, 0, 0, 0, 0}).data[0], 0x20);
  EXPECT_EQ(rig.client.read(0x6066, 0), 0x1234u);
}

TEST(Sdo, an_expedited_download_without_a_size_takes_the_objects_own) {
  DriveRig rig;
  EXPECT_EQ(rig.client.sdo({0x22, 0x66, 0x60, 0x00, 0x21, 0x43, 0, 0}).data[0], 0x60);
  EXPECT_EQ(rig.client.read(0x6066, 0), 0x4321u);
}

TEST(Sdo, the_refusal_of_a_block_transfer_names_the_object_that_was_asked_for) {
  DriveRig rig;
  rig.client.read(0x1A00, 1);
  const CanFrame up = rig.client.sdo({0xA0, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(up.data, (std::array<std::uint8_t, 8>{0x80, 0x08, 0x10, 0x00, 0x01, 0x00, 0x04, 0x05}));
  const CanFrame down = rig.client.sdo({0xC2, 0x00, 0x20, 0x00, 5, 0, 0, 0});
  EXPECT_EQ(down.data, (std::array<std::uint8_t, 8>{0x80, 0x00, 0x20, 0x00, 0x01, 0x00, 0x04, 0x05}));
}

TEST(Sdo, a_repeated_toggle_is_aborted_05030000) {
  DriveRig rig;
  rig.client.sdo({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  rig.client.sdo({0x60, 0, 0, 0, 0, 0, 0, 0});
  CanFrame answer = rig.client.sdo({0x60, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(answer.data[0], 0x80);
  EXPECT_EQ(Client::u32(answer, 4), 0x05030000u);
  EXPECT_EQ(answer.data[1] | (answer.data[2] << 8), 0x1008);

  rig.client.sdo({0x21, 0x00, 0x20, 0x00, 10, 0, 0, 0});
  answer = rig.client.sdo({0x10, 'x', 'x', 'x', 'x', 'x', 'x', 'x'});
  EXPECT_EQ(Client::u32(answer, 4), 0x05030000u);
}

TEST(Sdo, a_transfer_left_alone_is_aborted_05040000) {
  DriveRig rig;
  rig.client.sdo({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  rig.sent.clear();
  rig.run_ms(1000);
  for (const CanFrame& f : rig.sent) EXPECT_NE(f.id, 0x583u);
  rig.run_ms(2);
  bool aborted = false;
  for (const CanFrame& f : rig.sent) aborted = aborted || (f.id == 0x583 && f.data[0] == 0x80 && Client::u32(f, 4) == 0x05040000);
  EXPECT_TRUE(aborted);
}

TEST(Sdo, unknown_and_unasked_commands_are_aborted_05040001) {
  DriveRig rig;
  for (const int command : {0xA0, 0xC0, 0xE0, 0x60, 0x00}) {  // block upload, block download, reserved, segments of no transfer
    const CanFrame answer = rig.client.sdo({static_cast<std::uint8_t>(command), 0, 0, 0, 0, 0, 0, 0});
    EXPECT_EQ(answer.data[0], 0x80);
    EXPECT_EQ(Client::u32(answer, 4), 0x05040001u) << std::hex << command;
  }
}

TEST(Sdo, the_clients_abort_ends_a_transfer_without_an_answer) {
  DriveRig rig;
  rig.client.sdo({0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0});
  EXPECT_EQ(rig.client.sdo({0x80, 0x08, 0x10, 0, 0, 0, 4, 5}).length, 0);
  EXPECT_EQ(Client::u32(rig.client.sdo({0x60, 0, 0, 0, 0, 0, 0, 0}), 4), 0x05040001u);
}

TEST(Sdo, requests_of_less_than_eight_bytes_are_ignored) {
  DriveRig rig;
  EXPECT_EQ(rig.client.sdo({0x40, 0x00, 0x10, 0x00}).length, 0);
}

struct Refusal {
  const char* what;
  std::uint16_t index;
  std::uint8_t sub;
  std::int64_t value;
  std::size_t bytes;
  std::uint32_t code;
};

TEST(Sdo, every_bad_download_has_its_code) {
  const Refusal table[] = {
      {"constant", 0x1000, 0, 1, 4, 0x06010002},
      {"read-only position", 0x6064, 0, 1, 4, 0x06010002},
      {"no object", 0x5FFF, 0, 1, 4, 0x06020000},
      {"no sub-index", 0x607D, 3, 1, 4, 0x06090011},
      {"too long", 0x6066, 0, 1, 4, 0x06070012},
      {"too short", 0x6065, 0, 1, 2, 0x06070013},
      {"above the limit", 0x6072, 0, 3001, 2, 0x06090031},
      {"below the limit", 0x60C2, 1, 0, 1, 0x06090032},
      {"a quick stop option that is not supported", 0x605A, 0, 3, 2, 0x06090030},
      {"a mode that is not supported", 0x6060, 0, 4, 1, 0x06090030},
      {"a homing method that is not supported", 0x6098, 0, 17, 1, 0x06090030},
      {"an error history can only be emptied", 0x1003, 0, 3, 1, 0x06090030},
      {"SYNC producer", 0x1005, 0, 0x40000080, 4, 0x06090030},
      {"store without its signature", 0x1010, 1, 1, 4, 0x08000020},
      {"restore without its signature", 0x1011, 1, 1, 4, 0x08000020},
      {"a valid PDO's identifier", 0x1400, 1, 0x204, 4, 0x08000022},
      {"a valid PDO's mapping", 0x1600, 0, 0, 1, 0x08000022},
  };
  DriveRig rig;
  for (const Refusal& r : table) {
    SCOPED_TRACE(r.what);
    std::uint32_t read_code = 0;
    const std::uint32_t before = rig.client.read(r.index, r.sub, &read_code);
    EXPECT_EQ(rig.client.write(r.index, r.sub, r.value, r.bytes), r.code);
    if (read_code == 0) {
      EXPECT_EQ(rig.client.read(r.index, r.sub), before);
    }
  }
}

TEST(Sdo, a_write_only_object_is_not_read_06010001) {
  DriveRig rig;
  std::uint32_t code = 0;
  rig.client.read(0x0005, 0, &code);
  EXPECT_EQ(code, 0x06010001u);
  EXPECT_EQ(rig.client.write(0x0005, 0, 7, 1), 0u);
}

TEST(Sdo, bad_uploads_have_their_codes) {
  DriveRig rig;
  std::uint32_t code = 0;
  rig.client.read(0x5FFF, 0, &code);
  EXPECT_EQ(code, 0x06020000u);
  rig.client.read(0x1018, 9, &code);
  EXPECT_EQ(code, 0x06090011u);
}

TEST(Sdo, segmented_downloads_check_their_length) {
  DriveRig rig;
  EXPECT_EQ(Client::u32(rig.client.sdo({0x21, 0x00, 0x20, 0x00, 65, 0, 0, 0}), 4), 0x06070012u);  // announces more than fits
  EXPECT_EQ(Client::u32(rig.client.sdo({0x21, 0x00, 0x20, 0x00, 0, 0, 1, 0}), 4), 0x06070012u);   // absurd
  EXPECT_EQ(Client::u32(rig.client.sdo({0x21, 0x66, 0x60, 0x00, 1, 0, 0, 0}), 4), 0x06070013u);   // too short for a u16
  EXPECT_EQ(Client::u32(rig.client.sdo({0x21, 0x64, 0x60, 0x00, 4, 0, 0, 0}), 4), 0x06010002u);   // read-only
  rig.client.sdo({0x21, 0x00, 0x20, 0x00, 10, 0, 0, 0});
  EXPECT_EQ(Client::u32(rig.client.sdo({0x01, 'a', 'b', 'c', 'd', 'e', 'f', 'g'}), 4), 0x06070013u);  // ends early
  rig.client.sdo({0x21, 0x00, 0x20, 0x00, 4, 0, 0, 0});
  EXPECT_EQ(Client::u32(rig.client.sdo({0x01, 'a', 'b', 'c', 'd', 'e', 'f', 'g'}), 4), 0x06070012u);  // more than announced
}

TEST(Sdo, what_the_state_forbids_is_aborted_08000022) {
  DriveRig rig;
  rig.enable();
  EXPECT_EQ(rig.client.write(0x60C2, 1, 2, 1), 0x08000022u);
  EXPECT_EQ(rig.client.write(0x607C, 0, 2, 4), 0x08000022u);
  rig.controlword = 0;
  rig.run_ms(12);
  EXPECT_EQ(rig.client.write(0x60C2, 1, 4, 1), 0u);
}

TEST(Sdo, two_consumers_of_one_heartbeat_are_aborted_06040043) {
  DriveRig rig;
  EXPECT_EQ(rig.client.write(0x1016, 1, (0x7F << 16) | 300, 4), 0u);
  EXPECT_EQ(rig.client.write(0x1016, 2, (0x7F << 16) | 500, 4), 0x06040043u);
  EXPECT_EQ(rig.client.write(0x1016, 1, (0x7F << 16) | 500, 4), 0u);
}

TEST(Sdo, stored_values_survive_a_reset_and_factory_values_come_back) {
  DriveRig rig;
  EXPECT_EQ(rig.client.write(0x6066, 0, 77, 2), 0u);
  EXPECT_EQ(rig.client.write(0x1010, 1, 0x65766173, 4), 0u);
  EXPECT_EQ(rig.client.write(0x6066, 0, 78, 2), 0u);
  rig.client.nmt(129);
  rig.run_ms(10);
  EXPECT_EQ(rig.client.read(0x6066, 0), 77u);
  EXPECT_EQ(rig.client.write(0x1011, 1, 0x64616F6C, 4), 0u);
  rig.client.nmt(129);
  rig.run_ms(10);
  EXPECT_EQ(rig.client.read(0x6066, 0), 100u);
}

}  // namespace
}  // namespace lf::devices::test
