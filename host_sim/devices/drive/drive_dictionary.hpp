// A drive's dictionary as shared/drives/objects.csv has it, and the strict simulated drive's objects made of it.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/devices/canopen/object_dictionary.hpp"
#include "host_sim/devices/devices_config.hpp"

namespace lf::devices {

struct DictionaryRow {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  Type type = Type::u32;
  Access access = Access::read_write;
  std::string low, high, value;  // as the file writes them
  bool mappable = false;
};
using DriveDictionary = std::vector<DictionaryRow>;

// Throws InputError with file and line for a file that is not one, and for a drive that is not in it.
std::shared_ptr<const DriveDictionary> read_dictionary(const std::filesystem::path& file, const std::string& drive);

// The drive's objects with its dictionary's access, limits and defaults. What the dictionary does not have stays, marked absent, where the node itself works with
// it. `native` are the simulator's own objects.
std::vector<Object> strict_objects(const DriveConfig& config, const std::vector<Object>& native);

}  // namespace lf::devices
