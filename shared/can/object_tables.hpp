// The objects of the CAN map's devices, as rows: what shared/can/can_map.yaml says of them, made C++ by generate_can_files.py.
// Hosted side only: the simulated devices are built of them. EDS and DBC come from the same table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace lf::can_map {

enum class Type : std::uint8_t { u8, u16, u32, i8, i16, i32, text };
enum class Access : std::uint8_t { constant, read_only, write_only, read_write };
enum class Mapping : std::uint8_t { none = 0, receive = 1, transmit = 2, both = 3 };  // in which PDOs an object may stand

// Numbers that differ from node to node; can_map.yaml says what each is.
enum class Figure : std::uint8_t {
  none,  // 0
  node,
  stroke_low,
  stroke_high,
  following_window,
  velocity,
  velocity_back,
  cruise,
  creep,
  acceleration,
  peak_torque,
  rated_torque,
  water,
};

// The figure's value plus `plus`.
struct Number {
  Figure figure = Figure::none;
  std::int64_t plus = 0;
};
inline constexpr Number unlimited_low{Figure::none, std::numeric_limits<std::int64_t>::min()};  // the type's own range
inline constexpr Number unlimited_high{Figure::none, std::numeric_limits<std::int64_t>::max()};
inline constexpr const char* own_title = nullptr;  // a text that is the device's title

struct ObjectRow {
  std::uint16_t index;
  std::uint8_t sub;
  Type type;
  Access access;
  Mapping mapping;
  Number value, low, high;
  const char* text;
  std::size_t text_capacity;  // bytes that a download may have
  const char* name;
};

// An object with sub-indices.
enum class ObjectKind : std::uint8_t { array, record };
struct ObjectHead {
  std::uint16_t index;
  ObjectKind kind;
  const char* name;
};

// Who made the devices, and which edition of the table they are of.
struct Sheet {
  const char* vendor_name;
  std::uint32_t vendor, product, revision;
  int version;
  const char* date;  // month-day-year
};
Sheet sheet();

// By index and sub-index.
std::span<const ObjectRow> servo_drive_objects();
std::span<const ObjectHead> servo_drive_heads();
const char* servo_drive_title();
std::span<const ObjectRow> output_node_objects();
std::span<const ObjectHead> output_node_heads();
const char* output_node_title();

}  // namespace lf::can_map
