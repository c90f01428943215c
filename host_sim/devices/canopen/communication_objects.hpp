// A node's objects made of the CAN map's table, and the sizes that the map gives every node's communication objects (CiA 301).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/devices/canopen/object_dictionary.hpp"
#include "shared/can/object_tables.hpp"

namespace lf::devices {

inline constexpr std::size_t pdo_count = 4;             // in each direction
inline constexpr std::size_t max_mapped = 8;            // objects in a PDO
inline constexpr std::size_t error_history_length = 8;  // 1003
inline constexpr std::size_t consumer_count = 4;        // 1016

// `rows` with their numbers worked out, and the dummies 2 to 7, which stand for bytes of a received PDO that nobody wants (CiA 301, 7.4.8.1).
// `title` is object 1008. `figure` is asked for what differs from node to node, but `node`.
std::vector<Object> node_objects(std::span<const can_map::ObjectRow> rows, std::uint8_t node, const std::string& title,
                                 const std::function<std::int64_t(can_map::Figure)>& figure);

}  // namespace lf::devices
