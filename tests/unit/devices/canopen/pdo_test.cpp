// The order of re-mapping (CiA 301, 7.5.2.36), its refusals, and when data act.
#include <gtest/gtest.h>

#include "tests/unit/devices/drive/drive_rig.hpp"

namespace lf::devices::test {
namespace {

constexpr std::uint32_t rpdo1 = 0x203, tpdo1 = 0x40000183;

TEST(Pdo, a_pdo_is_re_mapped_in_the_right_order_and_reads_back) {
  DriveRig rig;
  EXPECT_EQ(rig.client.map(0x1400, rpdo1, 1, {0x60400010, 0x607A0020, 0x60B20010}), 0u);
  EXPECT_EQ(rig.client.read(0x1400, 1), rpdo1);
  EXPECT_EQ(rig.client.read(0x1400, 2), 1u);
  EXPECT_EQ(rig.client.read(0x1600, 0), 3u);
  EXPECT_EQ(rig.client.read(0x1600, 2), 0x607A0020u);
}

TEST(Pdo, wrong_mappings_are_refused_with_their_codes) {
  DriveRig rig;
  Client& c = rig.client;
  ASSERT_EQ(c.write(0x1400, 1, 0x80000000u | rpdo1, 4), 0u);
  EXPECT_EQ(c.write(0x1600, 1, 0x60400010, 4), 0x06010000u);  // sub 0 is not 0 yet
  ASSERT_EQ(c.write(0x1600, 0, 0, 1), 0u);
  EXPECT_EQ(c.write(0x1600, 1, 0x5FFF0010, 4), 0x06020000u);  // no such object
  EXPECT_EQ(c.write(0x1600, 1, 0x607D0920, 4), 0x06090011u);  // no such sub-index
  EXPECT_EQ(c.write(0x1600, 1, 0x60640020, 4), 0x06040041u);  // cannot be received
  EXPECT_EQ(c.write(0x1600, 1, 0x60650020, 4), 0x06040041u);  // not in any PDO
  EXPECT_EQ(c.write(0x1600, 1, 0x60400020, 4), 0x06040041u);  // 16 bits, not 32
  EXPECT_EQ(c.write(0x1600, 0, 1 + 8, 1), 0x06040042u);       // more than eight
  for (std::uint8_t sub = 1; sub <= 3; ++sub) ASSERT_EQ(c.write(0x1600, sub, 0x607A0020, 4), 0u);
  EXPECT_EQ(c.write(0x1600, 0, 3, 1), 0x06040042u);  // 96 bits
  EXPECT_EQ(c.write(0x1600, 0, 2, 1), 0u);
  EXPECT_EQ(c.write(0x1600, 0, 0, 1), 0u);
  ASSERT_EQ(c.write(0x1600, 2, 0, 4), 0u);
  EXPECT_EQ(c.write(0x1600, 0, 2, 1), 0x06020000u);  // an entry that is empty
  ASSERT_EQ(c.write(0x1800, 1, 0x80000000u | tpdo1, 4), 0u);
  ASSERT_EQ(c.write(0x1A00, 0, 0, 1), 0u);
  EXPECT_EQ(c.write(0x1A00, 1, 0x607A0020, 4), 0x06040041u);  // cannot be sent
}

TEST(Pdo, identifiers_of_other_services_and_unknown_types_are_refused) {
  DriveRig rig;
  ASSERT_EQ(rig.client.write(0x1400, 1, 0x80000000u | rpdo1, 4), 0u);
  for (const std::uint32_t id : {0x000u, 0x07Fu, 0x080u, 0x101u, 0x180u, 0x583u, 0x603u, 0x6E0u, 0x703u, 0x20000203u, 0x800u}) {
    EXPECT_EQ(rig.client.write(0x1400, 1, id, 4), 0x06090030u) << std::hex << id;
  }
  EXPECT_EQ(rig.client.write(0x1400, 1, 0x310, 4), 0u);
  for (const int type : {241, 252, 253}) EXPECT_EQ(rig.client.write(0x1401, 2, type, 1), 0x06090030u) << type;
  EXPECT_EQ(rig.client.write(0x1801, 3, 5, 2), 0x08000022u);  // inhibit time of a valid PDO
}

TEST(Pdo, set_points_act_at_the_next_sync_and_are_answered_one_later) {
  DriveRig rig;
  rig.configure();
  rig.cyclic = false;
  rig.controlword = 0x06;
  const auto statusword = [&] {
    const std::vector<CanFrame> answer = rig.client.sync();
    EXPECT_EQ(answer.size(), 1u);
    rig.run_ms(4);
    return answer.empty() ? -1 : (answer[0].data[0] & 0x6F);
  };
  EXPECT_EQ(statusword() & 0x4F, 0x40);
  rig.send_set_point();
  rig.run_ms(2);
  EXPECT_EQ(rig.status() & 0x4F, 0x40) << "before the SYNC nothing happens";
  EXPECT_EQ(statusword() & 0x4F, 0x40) << "this SYNC brings the data, and the answer from before them";
  EXPECT_EQ(statusword(), 0x21);
}

TEST(Pdo, of_two_set_points_between_syncs_the_last_counts) {
  DriveRig rig;
  rig.configure();
  rig.cyclic = false;
  rig.target = 11;
  rig.send_set_point();
  rig.target = 22;
  rig.send_set_point();
  rig.client.sync();
  EXPECT_EQ(rig.client.read(0x607A, 0), 22u);
}

TEST(Pdo, type_255_acts_at_once_and_sends_on_change) {
  DriveRig rig;
  ASSERT_EQ(rig.client.map(0x1400, rpdo1, 255, {0x60400010}), 0u);
  rig.client.nmt(1);
  rig.client.send(0x203, {0x06, 0x00});
  rig.sent.clear();
  rig.run_ms(20);
  EXPECT_EQ(rig.status() & 0x6F, 0x21);
  int changes = 0;
  for (const CanFrame& f : rig.sent) changes += f.id == 0x183 ? 1 : 0;
  EXPECT_EQ(changes, 1);
}

TEST(Pdo, every_third_sync_is_answered_at_type_three) {
  DriveRig rig;
  ASSERT_EQ(rig.client.map(0x1800, tpdo1, 3, {0x60410010}), 0u);
  rig.client.nmt(1);
  std::vector<std::size_t> answers;
  for (int i = 0; i < 7; ++i) answers.push_back(rig.client.sync().size());
  EXPECT_EQ(answers, (std::vector<std::size_t>{0, 0, 1, 0, 0, 1, 0}));
}

TEST(Pdo, nothing_moves_outside_operational) {
  DriveRig rig;
  rig.configure();
  rig.client.nmt(128);
  rig.cyclic = false;
  rig.controlword = 0x06;
  rig.send_set_point();
  EXPECT_TRUE(rig.client.sync().empty());
  EXPECT_EQ(rig.client.read(0x6040, 0), 0u);
}

TEST(Pdo, a_short_frame_is_not_used_and_makes_emcy_8210) {
  DriveRig rig;
  rig.configure();
  const std::vector<CanFrame> answer = rig.client.send(0x203, {0x06, 0, 1});
  EXPECT_EQ(emergency(answer, 3), 0x8210);
  EXPECT_EQ(rig.client.read(0x1001, 0) & 0x10, 0x10u);
  rig.client.sync();
  EXPECT_EQ(rig.client.read(0x6040, 0), 0u);
  EXPECT_EQ(emergency(rig.client.send(0x203, {0, 0, 0, 0, 0, 0, 0, 0}), 3), 0) << "a good one clears it";
}

TEST(Pdo, a_long_frame_is_used_and_makes_emcy_8220) {
  DriveRig rig;
  ASSERT_EQ(rig.client.map(0x1400, rpdo1, 255, {0x60400010}), 0u);
  rig.client.nmt(1);
  EXPECT_EQ(emergency(rig.client.send(0x203, {0x06, 0, 1}), 3), 0x8220);
  EXPECT_EQ(rig.client.read(0x6040, 0), 6u);
}

TEST(Pdo, values_outside_an_objects_limits_are_not_taken) {
  DriveRig rig;
  ASSERT_EQ(rig.client.map(0x1400, rpdo1, 255, {0x60720010}), 0u);
  rig.client.nmt(1);
  rig.client.send(0x203, {0xE8, 0x03});
  rig.client.send(0x203, {0xFF, 0xFF});
  EXPECT_EQ(rig.client.read(0x6072, 0), 1000u);
}

TEST(Pdo, a_missing_set_point_trips_8250_after_its_deadline) {
  DriveRig rig;
  ASSERT_EQ(rig.client.write(0x1400, 5, 20, 2), 0u);
  rig.enable();
  rig.sent.clear();
  rig.run_ms(40);
  EXPECT_EQ(emergency(rig.sent, 3), -1);
  rig.cyclic = false;
  rig.run_ms(17);
  EXPECT_EQ(emergency(rig.sent, 3), -1);
  rig.run_ms(8);
  EXPECT_EQ(emergency(rig.sent, 3), 0x8250);
  EXPECT_EQ(rig.drive.state(), DriveState::fault);
}

}  // namespace
}  // namespace lf::devices::test
