#include "hal/config/homing_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>

#include "firmware/arm/actuator.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::hal {
namespace {

using test::TemporaryFolder;

TEST(HomingFile, ComesBackAsItWentAndRefusesWhatIsNotValid) {
  const TemporaryFolder folder;
  config::HomingOffsets offsets;
  offsets.zero_counts = {1, 2, -3, 4, 5};
  offsets.known = {true, false, true, true, true};
  offsets.found[2] = "at its lower stop";
  offsets.friction_known[2] = true;
  offsets.friction[2] = {2.5, 0.0125, 0.25};
  config::write_homing_file(folder / "h.yaml", offsets);
  const config::HomingOffsets read = config::read_homing_file(folder / "h.yaml", {});
  EXPECT_EQ(read.zero_counts, (PerJoint<std::int32_t>{1, 0, -3, 4, 5}));
  EXPECT_EQ(read.known, offsets.known) << "commissioning one joint wrote zeros for the other four";
  EXPECT_EQ(read.found, offsets.found);
  EXPECT_EQ(read.friction_known, offsets.friction_known);
  arm::Friction friction{1, 1, 0.8, 0.75, 1, 0.05};
  config::set_friction(read, 0, friction);
  EXPECT_EQ(friction.coulomb_nm, 1) << "what was not found stays";
  config::set_friction(read, 2, friction);
  EXPECT_DOUBLE_EQ(friction.coulomb_nm, 2.5e-3);
  EXPECT_DOUBLE_EQ(friction.viscous_nm_s, 1.25e-5);
  EXPECT_DOUBLE_EQ(friction.doubt, 0.15) << "a tenth that the fit left, and a twentieth for another day";
  EXPECT_FALSE(std::filesystem::exists(folder / "h.yaml.partial"));
  EXPECT_THROW((void)config::read_homing_file(folder.write("a.yaml", "slew: {found: here}\n"), {}), InputError);
  EXPECT_THROW((void)config::read_homing_file(folder.write("b.yaml", "slew: {zero_counts: x}\n"), {}), InputError);
  EXPECT_THROW((void)config::read_homing_file(folder.write("d.yaml", "slew: {zero_counts: 1, coulomb_mnm: 2}\n"), {}), InputError);
  EXPECT_THROW((void)config::read_homing_file(folder.write("c.yaml", "neck: {zero_counts: 1}\n"), {}), InputError);
  EXPECT_THROW(config::write_homing_file(folder / "no/such/folder.yaml", offsets), InputError);
}

// The counts stay, so that a later commissioning is compared with them.
TEST(HomingFile, KeepsADoubtfulZeroWithItsCounts) {
  const TemporaryFolder folder;
  config::HomingOffsets offsets;
  offsets.zero_counts = {1, 2, -3, 4, 5};
  offsets.known = {true, true, true, true, false};
  offsets.friction_known[1] = true;
  offsets.friction[1] = {2.5, 0.0125, 0.25};
  offsets.found[1] = "at its stop";
  offsets.doubt_zero(1);
  offsets.doubt_friction(2);
  offsets.forget_zero(3);
  offsets.doubt_zero(4);  // which has none
  config::write_homing_file(folder / "h.yaml", offsets);
  const config::HomingOffsets read = config::read_homing_file(folder / "h.yaml", {});
  EXPECT_EQ(read.zero_counts, (PerJoint<std::int32_t>{1, 2, -3, 0, 0}));
  EXPECT_EQ(read.known, (PerJoint<bool>{true, false, false, false, false}));
  EXPECT_EQ(read.zero_doubtful, (PerJoint<bool>{false, true, true, false, false}));
  EXPECT_EQ(read.friction_doubtful, (PerJoint<bool>{false, false, true, false, false}));
  EXPECT_EQ(read.friction_known, offsets.friction_known);
  EXPECT_EQ(read.found, offsets.found);
  EXPECT_TRUE(read.has_earlier_zero(1) && read.has_earlier_zero(2) && !read.has_earlier_zero(3));
  EXPECT_EQ(config::read_homing_file(folder.write("o.yaml", "slew: {friction_doubtful: true, zero_counts: 7}\n"), {}).has_earlier_zero(0),
            false)
      << "without the mark, as before";
  for (const char* text : {"slew: {zero_doubtful: true}\n", "slew: {zero_doubtful: true, friction_doubtful: true}\n",
                           "slew: {zero_doubtful: 3, zero_counts: 1}\n"})
    EXPECT_THROW((void)config::read_homing_file(folder.write("a.yaml", text), {}), InputError) << text;
}

}  // namespace
}  // namespace lf::hal
