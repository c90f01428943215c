// The files that come with the programs.
#include "hal/config/share.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/unit/temporary_folder.hpp"

namespace lf::config {
namespace {

TEST(Share, AShippedFileIsKnownByEveryWayToIt) {
  const std::filesystem::path shipped = share_folder() / "homing" / "simulator.yaml";
  EXPECT_TRUE(is_shipped(shipped));
  EXPECT_TRUE(is_shipped(share_folder() / "vehicle" / ".." / "homing" / "simulator.yaml"));
  const test::TemporaryFolder folder;
  std::filesystem::create_symlink(shipped, folder / "mine.yaml");
  EXPECT_TRUE(is_shipped(folder / "mine.yaml"));
  EXPECT_FALSE(is_shipped(folder / "other.yaml")) << "not there yet";
  EXPECT_FALSE(is_shipped(share_folder().parent_path() / "README.md"));
}

}  // namespace
}  // namespace lf::config
