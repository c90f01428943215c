// The objects 0x0002 to 0x1FFF that every node here has (CiA 301), with the defaults a drive comes with.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host_sim/devices/object_dictionary.hpp"

namespace lf::devices {

inline constexpr std::size_t pdo_count = 4;             // in each direction
inline constexpr std::size_t max_mapped = 8;            // objects in a PDO
inline constexpr std::size_t error_history_length = 8;  // 1003
inline constexpr std::size_t consumer_count = 4;        // 1016

// What a PDO carries before anybody re-maps it: entries as in 1600, index << 16 | sub << 8 | bits.
struct PdoDefaults {
  std::vector<std::uint32_t> receive[pdo_count];
  std::vector<std::uint32_t> transmit[pdo_count];
};

// `device_type` is object 1000, `name` 1008. PDOs without default entries start invalid (bit 31 of their COB-ID).
std::vector<Object> communication_objects(std::uint8_t node, std::uint32_t device_type, const std::string& name, const PdoDefaults& pdos);

}  // namespace lf::devices
