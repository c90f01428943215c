#include "host_sim/scenario/drive_make.hpp"

#include <vector>

#include "hal/config/drive_kind.hpp"

namespace lf::scenario {

std::optional<DriveMake> find_make(const std::string& profile, const std::filesystem::path& folder) {
  std::vector<std::string> makes{std::filesystem::path(profile).stem()};
  for (const std::string& file : config::find_drive_kind(profile, folder).like) makes.push_back(std::filesystem::path(file).stem());
  for (const std::string& make : makes) {
    if (const devices::DriveHabit* habit = devices::find_habit(make)) return DriveMake{habit};
    if (make == "lanternfish" || make.starts_with("cia402")) return DriveMake{};
  }
  return std::nullopt;
}

}  // namespace lf::scenario
