#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/config/limits_file.hpp"
#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

namespace lf::config {

namespace {

std::string shipped_text() { return read_text_file(share_folder() / "safety" / "limits.yaml"); }

std::string changed(const std::string& from, const std::string& to) {
  std::string text = shipped_text();
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string said_of(const std::string& text) {
  const scenario::ScenarioFile file(text);
  try {
    (void)read_limits(file.path());
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace

TEST(Limits, TheShippedFileIsGoodAndTheCoreAgrees) {
  const safety::Limits limits = read_limits(share_folder() / "safety" / "limits.yaml");
  EXPECT_EQ(safety::check(limits), safety::LimitsVerdict::good);
  EXPECT_EQ(limits.stale_position_s, 0.012) << "three SYNC cycles";
}

TEST(Limits, AChangedValueWithoutItsChecksumIsRefusedAndTheRightOneNamed) {
  EXPECT_THAT(said_of(changed("max_contact_torque_nm: 13", "max_contact_torque_nm: 14")), ::testing::HasSubstr("these limits give 0x"));
}

TEST(Limits, EveryLimitHasToBeStated) {
  EXPECT_THAT(said_of(changed("vision_timeout_s: 2.0", "")), ::testing::HasSubstr("'vision_timeout_s' is missing"));
  EXPECT_THAT(said_of(changed("max_torque_nm: 26}", "}")), ::testing::HasSubstr("'joints.slew.max_torque_nm' is missing"));
}

TEST(Limits, MisspeltAndSenselessOnesAreRefusedWithTheirLine) {
  EXPECT_THAT(said_of(changed("stale_image_s", "stale_imag_s")), ::testing::HasSubstr("did you mean 'stale_image_s'?"));
  EXPECT_THAT(said_of(changed("vision_timeout_s: 2.0", "vision_timeout_s: .nan")), ::testing::HasSubstr("must be a finite number"));
  EXPECT_THAT(said_of(changed("checksum: 0x", "checksum: 1x")), ::testing::HasSubstr("'checksum' takes 0x and 8 hex digits"));
  EXPECT_THAT(said_of("3"), ::testing::HasSubstr(":1: not a file of safety limits"));
}

}  // namespace lf::config
