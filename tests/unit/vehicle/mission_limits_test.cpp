// A mission's own limits beside the machine's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "hal/vehicle/vehicle_config.hpp"
#include "tests/unit/changed_text.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "tests/unit/vehicle/config_problems.hpp"

namespace lf::hal {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

// A file of the machine's limits with the elbow's top speed changed, and its right checksum, which the reader names.
std::string limits_with_elbow_speed(const TemporaryFolder& folder, const std::string& rad_s) {
  std::ifstream shipped(LANTERNFISH_SOURCE_DIR "/shared/safety/limits.yaml");
  std::string text((std::istreambuf_iterator<char>(shipped)), {});
  test::change(text, "0.36", rad_s);
  const std::string file = folder.write("mission.yaml", text);
  const std::string named = problems_of(folder.write("probe.yaml", "safety: {limits: mission.yaml}\n")).front();
  const std::string right = named.substr(named.rfind("0x"), 10);
  text.replace(text.find("checksum: 0x") + 10, 10, right);
  return folder.write("mission.yaml", text);
}

TEST(VehicleConfig, AMissionsOwnLimitsTightenAndNeverWiden) {
  const TemporaryFolder folder;
  const std::string vehicle = folder.write("v.yaml", "safety: {mission_limits: mission.yaml}\n");
  limits_with_elbow_speed(folder, "0.30");
  const VehicleConfig config = load_vehicle_config(vehicle);
  EXPECT_EQ(config.core.controller.mission_limits.joints[2].max_speed_rad_s, 0.30);
  EXPECT_EQ(config.core.controller.limits.joints[2].max_speed_rad_s, 0.36);
  EXPECT_EQ(config.core.controller.mission_limits.joints[1], config.core.controller.limits.joints[1]);
  limits_with_elbow_speed(folder, "0.37");
  EXPECT_THAT(problems_of(vehicle), testing::Contains(HasSubstr("one of these is wider than in 'safety.limits'")));
  EXPECT_THAT(problems_of(folder.write("w.yaml", "safety: {mission_limits: none.yaml}\n")), testing::Contains(HasSubstr("none.yaml")));
}

}  // namespace
}  // namespace lf::hal
