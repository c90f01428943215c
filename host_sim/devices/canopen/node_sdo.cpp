// What an SDO may do to the node's own objects, and what follows from it.
#include "host_sim/devices/canopen/node.hpp"

namespace lf::devices {
namespace {

constexpr std::int64_t signature_save = 0x65766173;  // "save", object 1010
constexpr std::int64_t signature_load = 0x64616F6C;  // "load", object 1011

bool is_communication(std::uint16_t index) { return index >= 0x1000 && index <= 0x1FFF; }

}  // namespace

Abort Node::sdo_read(std::uint16_t index, std::uint8_t sub, std::vector<std::uint8_t>& bytes) {
  Object* object = nullptr;
  const Abort code = objects_.resolve(index, sub, object);
  if (code != Abort::none) return code;
  if (!object->readable()) return Abort::write_only;
  if (index == 0x1003 && sub > objects_.at(0x1003, 0).value) return Abort::no_sub_index;
  if (object->type == Type::text) {
    bytes.assign(object->text.begin(), object->text.end());
    return Abort::none;
  }
  bytes.resize(size_of(object->type));
  encode(object->type, object->value, bytes.data());
  return Abort::none;
}

Abort Node::sdo_may_write(std::uint16_t index, std::uint8_t sub, std::size_t size) {
  Object* object = nullptr;
  const Abort code = objects_.resolve(index, sub, object);
  if (code != Abort::none) return code;
  if (!object->writable()) return Abort::read_only;
  if (size == 0) return Abort::none;
  if (object->type == Type::text) return size > object->text_capacity ? Abort::too_long : Abort::none;
  if (size == size_of(object->type)) return Abort::none;
  return size > size_of(object->type) ? Abort::too_long : Abort::too_short;
}

Abort Node::sdo_write(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> bytes, Time now) {
  Object* object = nullptr;
  std::int64_t value = 0;
  Abort code = objects_.resolve(index, sub, object);
  if (code == Abort::none) code = check_download(*object, bytes, value);
  if (code == Abort::none) code = is_communication(index) ? check_communication(*object, value) : application_.may_write(*object, value);
  if (code != Abort::none) return code;
  if (object->type == Type::text) {
    object->text.assign(bytes.begin(), bytes.end());
    return Abort::none;
  }
  if (index == 0x1010 || index == 0x1011) {
    index == 0x1010 ? objects_.store() : objects_.load_factory();
    return Abort::none;
  }
  object->value = value;
  if (is_communication(index)) {
    communication_written(*object, now);
  } else {
    application_.written(*object, now);
  }
  return Abort::none;
}

Abort Node::check_communication(const Object& object, std::int64_t value) {
  if (is_pdo_parameter(object.index)) return check_pdo_parameter(objects_, object, value);
  switch (object.index) {
    case 0x1003: return value == 0 ? Abort::none : Abort::bad_value;
    case 0x1005: return (value & 0x40000000) != 0 || (value & 0x7FF) == 0 || (value & 0x3FFFF800) != 0 ? Abort::bad_value : Abort::none;
    case 0x1010: return value == signature_save ? Abort::none : Abort::cannot_store;
    case 0x1011: return value == signature_load ? Abort::none : Abort::cannot_store;
    default: break;
  }
  if (object.index != 0x1016 || (value & 0xFFFF) == 0) return Abort::none;
  const std::int64_t node = value >> 16;
  if (node < 1 || node > 127) return Abort::bad_value;
  for (std::uint8_t sub = 1; sub <= consumer_count; ++sub) {
    const std::int64_t other = objects_.at(0x1016, sub).value;
    if (sub != object.sub && (other & 0xFFFF) != 0 && (other >> 16) == node) return Abort::parameters_incompatible;
  }
  return Abort::none;
}

void Node::communication_written(const Object& object, Time now) {
  if (object.index == 0x1017) next_heartbeat_ = now;
  if (object.index == 0x1016) configure_consumers();
  if (!is_pdo_parameter(object.index)) return;
  const std::size_t i = object.index & 3;
  if (object.index < 0x1800) {
    receive_[i].configure(objects_, static_cast<std::uint16_t>(0x1400 + i));
  } else {
    transmit_[i].configure(objects_, static_cast<std::uint16_t>(0x1800 + i));
  }
}

}  // namespace lf::devices
