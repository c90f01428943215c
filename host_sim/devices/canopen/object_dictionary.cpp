#include "host_sim/devices/canopen/object_dictionary.hpp"

#include <algorithm>

#include "shared/input_error.hpp"

namespace lf::devices {
namespace {

std::uint32_t key(const Object& object) { return (std::uint32_t{object.index} << 8) | object.sub; }

bool is_signed(Type type) { return type == Type::i8 || type == Type::i16 || type == Type::i32; }

std::string name(std::uint16_t index, std::uint8_t sub) {
  constexpr char digits[] = "0123456789ABCDEF";
  std::string text;
  for (int shift = 12; shift >= 0; shift -= 4) text += digits[(index >> shift) & 0xF];
  return text + ":" + digits[sub >> 4] + digits[sub & 0xF];
}

}  // namespace

std::int64_t decode(Type type, std::span<const std::uint8_t> bytes) {
  std::uint64_t raw = 0;
  const std::size_t size = std::min(size_of(type), bytes.size());
  for (std::size_t i = 0; i < size; ++i) raw |= std::uint64_t{bytes[i]} << (8 * i);
  if (is_signed(type) && size > 0 && ((raw >> (8 * size - 1)) & 1u) != 0) raw |= ~std::uint64_t{0} << (8 * size);
  return static_cast<std::int64_t>(raw);
}

void encode(Type type, std::int64_t value, std::uint8_t* bytes) {
  for (std::size_t i = 0; i < size_of(type); ++i) bytes[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
}

ObjectDictionary::ObjectDictionary(std::vector<Object> objects) : objects_(std::move(objects)) {
  std::sort(objects_.begin(), objects_.end(), [](const Object& a, const Object& b) { return key(a) < key(b); });
  for (std::size_t i = 1; i < objects_.size(); ++i) {
    if (key(objects_[i]) == key(objects_[i - 1])) throw InputError("object " + name(objects_[i].index, objects_[i].sub) + " stands twice");
  }
  for (Object& object : objects_) object.power_on = object.factory = object.value;
}

Object* ObjectDictionary::find(std::uint16_t index, std::uint8_t sub) {
  const std::uint32_t wanted = (std::uint32_t{index} << 8) | sub;
  const auto found =
      std::lower_bound(objects_.begin(), objects_.end(), wanted, [](const Object& o, std::uint32_t k) { return key(o) < k; });
  return found != objects_.end() && key(*found) == wanted ? &*found : nullptr;
}

const Object* ObjectDictionary::find(std::uint16_t index, std::uint8_t sub) const {
  return const_cast<ObjectDictionary*>(this)->find(index, sub);
}

Object& ObjectDictionary::at(std::uint16_t index, std::uint8_t sub) {
  Object* object = find(index, sub);
  if (object == nullptr) throw InputError("the device has no object " + name(index, sub));
  return *object;
}

Abort ObjectDictionary::resolve(std::uint16_t index, std::uint8_t sub, Object*& object) {
  object = find(index, sub);
  if (object != nullptr && !object->absent) return Abort::none;
  object = nullptr;
  const std::uint32_t first = std::uint32_t{index} << 8;
  auto other = std::lower_bound(objects_.begin(), objects_.end(), first, [](const Object& o, std::uint32_t k) { return key(o) < k; });
  while (other != objects_.end() && other->index == index && other->absent) ++other;
  return other != objects_.end() && other->index == index ? Abort::no_sub_index : Abort::no_object;
}

void ObjectDictionary::reset(std::uint16_t first, std::uint16_t last) {
  for (Object& object : objects_) {
    if (object.index >= first && object.index <= last) object.value = object.power_on;
  }
}

void ObjectDictionary::store() {
  for (Object& object : objects_) {
    if (object.access == Access::read_write) object.power_on = object.value;
  }
}

void ObjectDictionary::load_factory() {
  for (Object& object : objects_) object.power_on = object.factory;
}

Abort check_limits(const Object& object, std::int64_t value) {
  if (value > object.high) return Abort::too_high;
  if (value < object.low) return Abort::too_low;
  return Abort::none;
}

Abort check_download(const Object& object, std::span<const std::uint8_t> bytes, std::int64_t& value) {
  if (!object.writable()) return Abort::read_only;
  if (object.type == Type::text) return bytes.size() > object.text_capacity ? Abort::too_long : Abort::none;
  const std::size_t size = size_of(object.type);
  if (bytes.size() > size) return Abort::too_long;
  if (bytes.size() < size) return Abort::too_short;
  value = decode(object.type, bytes);
  return check_limits(object, value);
}

}  // namespace lf::devices
