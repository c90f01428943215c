// Where a vehicle's file puts what it names: relative paths, links, and the socket of a stop.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "hal/vehicle/vehicle_config.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::hal {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

// A link that is put elsewhere while a daemon runs: the socket is looked for where the link is, and a lock beside the file itself would be another one.
TEST(VehiclePlaces, AFileReachedByALinkHasItsPlacesBesideTheLinkAndALockWithAFullPath) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "release");
  std::ofstream(folder.path() / "release/v.yaml") << "operator: {socket: op.sock}\nlock_folder: lock\n";
  std::filesystem::create_symlink("release/v.yaml", folder.path() / "v.yaml");
  std::vector<std::string> problems;
  const VehicleConfig config = load_vehicle_config(folder / "v.yaml", problems);
  EXPECT_EQ(config.operator_socket, folder / "op.sock");
  EXPECT_THAT(problems, ::testing::Contains(HasSubstr("'lock_folder' is relative, and this file is reached by a link")));
  problems.clear();
  (void)load_vehicle_config((folder.path() / "release/v.yaml").string(), problems);
  EXPECT_THAT(problems, ::testing::IsEmpty());
}

// A stop goes to the file's own socket wherever that can be read. A folder's name is no problem of a key.
TEST(VehiclePlaces, TheSocketOfAStopIsTheFilesWhereverItCanBeRead) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "operator");
  const auto socket_of = [&](const std::string& text) {
    std::ofstream(folder.path() / "operator/v.yaml") << text;
    const StopSocket found = stop_socket(folder / "operator/v.yaml");
    return found.told && found.paths.size() == 1 ? found.paths[0] : "";
  };
  const std::string usual = VehicleConfig().operator_socket;
  EXPECT_EQ(socket_of("operator: {socket: op.sock}\nrealtime: {priority: 500}\n"), folder / "operator/op.sock");
  EXPECT_EQ(socket_of("operator: {socket: op.sock, grop: x}\n"), folder / "operator/op.sock");
  EXPECT_EQ(socket_of("realtime: {priority: 500}\n"), usual) << "it has the usual one, and is only wrong elsewhere";
  EXPECT_EQ(socket_of("operator: {socket: " + usual + "}\nrealtme: {priority: 5}\n"), usual) << "as the shipped file has it";
  EXPECT_EQ(socket_of("operator: {soket: op.sock}\n"), "");
  EXPECT_EQ(socket_of("oprtr: {socket: op.sock}\n"), "");
  EXPECT_EQ(socket_of("operator: {socket: [a, b]}\n"), "");
  EXPECT_EQ(socket_of("operator: {\n"), "");
}

// The daemon may run by the one name, and who stops it give the other.
TEST(VehiclePlaces, AStopOfALinkedFileGoesBesideBothNames) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "release");
  std::ofstream(folder.path() / "release/v.yaml") << "operator: {socket: op.sock}\n";
  std::filesystem::create_symlink("release/v.yaml", folder.path() / "v.yaml");
  const StopSocket found = stop_socket(folder / "v.yaml");
  EXPECT_TRUE(found.told);
  EXPECT_THAT(found.paths, ::testing::ElementsAre(folder / "op.sock", folder / "release/op.sock"));
}

// `folder/..` of a folder that is a link is not where it seems.
TEST(VehiclePlaces, ALockBesideAFileWhoseNameLeadsThroughALinkIsRefused) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "real/inner");
  std::filesystem::create_directory_symlink("real/inner", folder.path() / "link");
  std::ofstream(folder.path() / "real/v.yaml") << "lock_folder: lock\n";
  std::vector<std::string> problems;
  (void)load_vehicle_config(folder / "link/../v.yaml", problems);
  EXPECT_THAT(problems, ::testing::Contains(HasSubstr("'lock_folder' is relative, and this file is reached by a link")));
}

// They went by the working directory, which a service and a shell do not share.
TEST(VehiclePlaces, RelativePathsAreBesideTheFile) {
  const TemporaryFolder folder;
  const VehicleConfig config = load_vehicle_config(folder.write("v.yaml",
                                                                "camera: {device: video9, ring: ../ring}\n"
                                                                "operator: {socket: op.sock}\n"
                                                                "estop: {input: gpio/value}\n"
                                                                "log: {folder: log}\n"
                                                                "lock_folder: .\n"));
  const std::filesystem::path beside = folder.path();
  EXPECT_EQ(config.device, (beside / "video9").string());
  EXPECT_EQ(config.ring, (beside.parent_path() / "ring").string());
  EXPECT_EQ(config.operator_socket, (beside / "op.sock").string());
  EXPECT_EQ(config.estop_input, (beside / "gpio/value").string());
  EXPECT_EQ(config.log_folder, (beside / "log").string());
  EXPECT_EQ(std::filesystem::weakly_canonical(config.lock_folder), std::filesystem::weakly_canonical(beside));
  const VehicleConfig usual = load_vehicle_config(folder.write("empty.yaml", "estop: {input: \"\"}\n"));
  EXPECT_EQ(usual.estop_input, "") << "none is none";
  EXPECT_EQ(usual.ring, "");
  EXPECT_EQ(usual.log_folder, VehicleConfig().log_folder);
}

}  // namespace
}  // namespace lf::hal
