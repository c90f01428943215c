// Which simulated drive stands for a profile of the machine's file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "host_sim/devices/drive/drive_habits.hpp"

namespace lf::scenario {

// Null: the simulator's own, with the objects of the CAN map.
struct DriveMake {
  const devices::DriveHabit* habit = nullptr;
};

// The profile's own make, or the nearest of those that it is like; nothing where none of them is simulated. `folder`: where profiles of one's own are looked for.
// Throws InputError for a profile that cannot be read.
std::optional<DriveMake> find_make(const std::string& profile, const std::filesystem::path& folder);

}  // namespace lf::scenario
