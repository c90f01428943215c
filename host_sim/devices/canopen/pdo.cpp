#include "host_sim/devices/canopen/pdo.hpp"

#include <algorithm>

namespace lf::devices {
namespace {

constexpr std::uint32_t invalid_bit = 0x80000000u;
constexpr std::uint32_t extended_bit = 0x20000000u;

bool is_mapping(std::uint16_t index) { return (index & 0xFFFC) == 0x1600 || (index & 0xFFFC) == 0x1A00; }
bool transmits(std::uint16_t index) { return index >= 0x1800; }

// CiA 301, table 40: identifiers that other services own.
bool reserved(std::uint32_t id) {
  const auto within = [id](std::uint32_t low, std::uint32_t high) { return id >= low && id <= high; };
  return within(0x000, 0x07F) || id == 0x080 || within(0x101, 0x180) || within(0x581, 0x5FF) || within(0x601, 0x67F) ||
         within(0x6E0, 0x6FF) || within(0x701, 0x7FF) || id > 0x7FF;
}

Abort check_entry(ObjectDictionary& objects, std::uint32_t entry, bool transmit) {
  Object* object = nullptr;
  const Abort found = objects.resolve(static_cast<std::uint16_t>(entry >> 16), static_cast<std::uint8_t>(entry >> 8), object);
  if (found != Abort::none) return found;
  const auto wanted = static_cast<std::uint8_t>(transmit ? Mapping::transmit : Mapping::receive);
  if ((static_cast<std::uint8_t>(object->mapping) & wanted) == 0) return Abort::not_mappable;
  return (entry & 0xFF) == 8 * size_of(object->type) ? Abort::none : Abort::not_mappable;
}

Abort check_mapping(ObjectDictionary& objects, const Object& parameter, std::int64_t value) {
  const auto count = objects.at(parameter.index, 0).value;
  if (parameter.sub != 0) {
    if (count != 0) return Abort::unsupported_access;
    return value == 0 ? Abort::none : check_entry(objects, static_cast<std::uint32_t>(value), transmits(parameter.index));
  }
  if (value > static_cast<std::int64_t>(max_mapped)) return Abort::mapping_too_long;
  std::uint32_t bits = 0;
  for (std::int64_t i = 1; i <= value; ++i) {
    const auto entry = static_cast<std::uint32_t>(objects.at(parameter.index, static_cast<std::uint8_t>(i)).value);
    const Abort code = check_entry(objects, entry, transmits(parameter.index));
    if (code != Abort::none) return code;
    bits += entry & 0xFF;
  }
  return bits > 64 ? Abort::mapping_too_long : Abort::none;
}

Abort check_cob_id(std::uint32_t before, std::uint32_t after) {
  if ((after & extended_bit) != 0) return Abort::bad_value;
  const bool was_valid = (before & invalid_bit) == 0;
  const bool stays_valid = (after & invalid_bit) == 0;
  if (was_valid && stays_valid && before != after) return Abort::device_state;
  return stays_valid && reserved(after & 0x1FFFFFFFu) ? Abort::bad_value : Abort::none;
}

}  // namespace

bool is_pdo_parameter(std::uint16_t index) {
  const std::uint16_t base = index & 0xFFFC;
  return base == 0x1400 || base == 0x1600 || base == 0x1800 || base == 0x1A00;
}

Abort check_pdo_parameter(ObjectDictionary& objects, const Object& parameter, std::int64_t value) {
  const bool mapping = is_mapping(parameter.index);
  const auto communication = static_cast<std::uint16_t>(mapping ? parameter.index - 0x200 : parameter.index);
  const auto cob_id = static_cast<std::uint32_t>(objects.at(communication, 1).value);
  const bool valid = (cob_id & invalid_bit) == 0;
  if (mapping) return valid ? Abort::device_state : check_mapping(objects, parameter, value);
  switch (parameter.sub) {
    case 1: return check_cob_id(cob_id, static_cast<std::uint32_t>(value));
    case 2: return value > 240 && value < 254 ? Abort::bad_value : Abort::none;
    case 3: return valid ? Abort::device_state : Abort::none;
    default: return Abort::none;
  }
}

void Pdo::configure(ObjectDictionary& objects, std::uint16_t communication) {
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  const auto cob_id = static_cast<std::uint32_t>(objects.at(communication, 1).value);
  *this = Pdo{};
  valid_ = (cob_id & invalid_bit) == 0;
  cob_id_ = cob_id & 0x7FF;
  type_ = static_cast<std::uint8_t>(objects.at(communication, 2).value);
  inhibit = Duration::from_us(100 * objects.at(communication, 3).value);
  event_timer = Duration::from_ms(objects.at(communication, 5).value);
  count_ = std::min(max_mapped, static_cast<std::size_t>(objects.at(mapping, 0).value));
  for (std::size_t i = 0; i < count_; ++i) {
    const auto entry = static_cast<std::uint32_t>(objects.at(mapping, static_cast<std::uint8_t>(i + 1)).value);
    mapped_[i] = objects.find(static_cast<std::uint16_t>(entry >> 16), static_cast<std::uint8_t>(entry >> 8));
    if (mapped_[i] == nullptr) {  // a maker's default that names an object which the list of its objects leaves out
      valid_ = false;
      count_ = bytes_ = 0;
      return;
    }
    bytes_ = static_cast<std::uint8_t>(bytes_ + size_of(mapped_[i]->type));
  }
}

CanFrame Pdo::pack() const {
  CanFrame frame;
  frame.id = cob_id_;
  frame.length = bytes_;
  std::size_t at = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    encode(mapped_[i]->type, mapped_[i]->value, frame.data.data() + at);
    at += size_of(mapped_[i]->type);
  }
  return frame;
}

void Pdo::unpack(std::span<const std::uint8_t> data) const {
  std::size_t at = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const std::size_t size = size_of(mapped_[i]->type);
    const std::int64_t value = decode(mapped_[i]->type, data.subspan(at, size));
    if (check_limits(*mapped_[i], value) == Abort::none) mapped_[i]->value = value;
    at += size;
  }
}

}  // namespace lf::devices
