// A CANopen device's objects (CiA 301): typed entries with access rights, limits and their values.
//
// Values are held as integers of at most 32 bits, or as text. What an object means is the business of the node and of its application.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "shared/can/object_tables.hpp"

namespace lf::devices {

// SDO abort codes (CiA 301, table 22).
enum class Abort : std::uint32_t {
  none = 0,
  toggle = 0x05030000,
  timeout = 0x05040000,
  command = 0x05040001,
  unsupported_access = 0x06010000,
  write_only = 0x06010001,
  read_only = 0x06010002,
  no_object = 0x06020000,
  not_mappable = 0x06040041,
  mapping_too_long = 0x06040042,
  parameters_incompatible = 0x06040043,
  length_mismatch = 0x06070010,
  too_long = 0x06070012,
  too_short = 0x06070013,
  no_sub_index = 0x06090011,
  bad_value = 0x06090030,
  too_high = 0x06090031,
  too_low = 0x06090032,
  general = 0x08000000,
  cannot_store = 0x08000020,
  device_state = 0x08000022,
};

using can_map::Access;
using can_map::Mapping;
using can_map::Type;

constexpr std::size_t size_of(Type type) {
  switch (type) {
    case Type::u8:
    case Type::i8: return 1;
    case Type::u16:
    case Type::i16: return 2;
    case Type::u32:
    case Type::i32: return 4;
    case Type::text: break;
  }
  return 0;
}

struct Object {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  Type type = Type::u32;
  Access access = Access::read_write;
  Mapping mapping = Mapping::none;
  std::int64_t value = 0;
  std::int64_t low = std::numeric_limits<std::int64_t>::min();  // beyond the type's own range: no limit
  std::int64_t high = std::numeric_limits<std::int64_t>::max();
  std::string text = {};          // Type::text only
  std::size_t text_capacity = 0;  // bytes that a download may have

  bool absent = false;  // the node works with it, and nobody finds it over the bus

  std::int64_t power_on = 0;  // value after a reset; set by the dictionary
  std::int64_t factory = 0;

  bool readable() const { return access != Access::write_only; }
  bool writable() const { return access == Access::write_only || access == Access::read_write; }
};

// Bytes of the wire, least significant first.
std::int64_t decode(Type type, std::span<const std::uint8_t> bytes);
void encode(Type type, std::int64_t value, std::uint8_t* bytes);

class ObjectDictionary {
 public:
  // Values become the power-on and the factory values. Throws InputError when an object stands twice.
  explicit ObjectDictionary(std::vector<Object> objects);

  // nullptr when there is none. O(log n). Addresses stay valid as long as the dictionary.
  Object* find(std::uint16_t index, std::uint8_t sub);
  const Object* find(std::uint16_t index, std::uint8_t sub) const;
  // An object that the device was built with. Throws InputError when it was not.
  Object& at(std::uint16_t index, std::uint8_t sub = 0);

  // Finds an object, or says why not: no_object, no_sub_index.
  Abort resolve(std::uint16_t index, std::uint8_t sub, Object*& object);

  // Objects of [first, last] take their power-on values.
  void reset(std::uint16_t first, std::uint16_t last);
  void store();         // values that can be written become the power-on values
  void load_factory();  // the next reset takes the factory values

 private:
  std::vector<Object> objects_;
};

// Checks an SDO download against type, access and limits. `value` is set for all but text.
Abort check_download(const Object& object, std::span<const std::uint8_t> bytes, std::int64_t& value);
// The same for a value that has already the object's type.
Abort check_limits(const Object& object, std::int64_t value);

}  // namespace lf::devices
