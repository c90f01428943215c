#include "host_sim/devices/communication_objects.hpp"

#include "shared/can/can_map.hpp"

namespace lf::devices {
namespace {

constexpr std::uint32_t invalid_pdo = 0x80000000u;
constexpr std::uint32_t no_remote = 0x40000000u;
constexpr std::uint32_t vendor = 0x00000000u;   // none: this is no CiA member's device
constexpr std::uint32_t product = 0x4C465331u;  // "LFS1"
constexpr std::uint32_t revision = 0x00010000u;
constexpr std::int64_t default_type = 255;           // event-driven
constexpr std::int64_t default_inhibit_100us = 100;  // 10 ms: a drive left at its defaults does not fill the bus with 6064

std::uint16_t at(std::uint16_t base, std::size_t i) { return static_cast<std::uint16_t>(base + i); }

Object constant(std::uint16_t index, std::uint8_t sub, Type type, std::int64_t value) {
  return {.index = index, .sub = sub, .type = type, .access = Access::constant, .value = value};
}

Object variable(std::uint16_t index, std::uint8_t sub, Type type, std::int64_t value, Access access = Access::read_write) {
  return {.index = index, .sub = sub, .type = type, .access = access, .value = value};
}

// Objects 2 to 7 stand for bytes of a received PDO that nobody wants (CiA 301, 7.4.8.1).
void add_dummies(std::vector<Object>& objects) {
  constexpr Type types[] = {Type::i8, Type::i16, Type::i32, Type::u8, Type::u16, Type::u32};
  for (std::size_t i = 0; i < 6; ++i) {
    Object dummy = variable(at(0x0002, i), 0, types[i], 0, Access::write_only);
    dummy.mapping = Mapping::receive;
    objects.push_back(dummy);
  }
}

void add_identity(std::vector<Object>& objects, std::uint8_t node, std::uint32_t device_type, const std::string& name) {
  const auto add_text = [&](std::uint16_t index, const std::string& text) {
    Object object = constant(index, 0, Type::text, 0);
    object.text = text;
    objects.push_back(object);
  };
  objects.push_back(constant(0x1000, 0, Type::u32, device_type));
  add_text(0x1008, name);
  add_text(0x1009, "1");
  add_text(0x100A, "1.0");
  const std::uint32_t identity[] = {4, vendor, product, revision, node};
  for (std::uint8_t sub = 0; sub < 5; ++sub) objects.push_back(constant(0x1018, sub, sub == 0 ? Type::u8 : Type::u32, identity[sub]));
  Object tag = variable(0x2000, 0, Type::text, 0);  // a name the user gives, up to 64 bytes
  tag.text_capacity = 64;
  objects.push_back(tag);
}

void add_errors(std::vector<Object>& objects, std::uint8_t node) {
  Object reg = variable(0x1001, 0, Type::u8, 0, Access::read_only);
  reg.mapping = Mapping::transmit;
  objects.push_back(reg);
  Object count = variable(0x1003, 0, Type::u8, 0);
  objects.push_back(count);
  for (std::size_t i = 1; i <= error_history_length; ++i) {
    objects.push_back(variable(0x1003, static_cast<std::uint8_t>(i), Type::u32, 0, Access::read_only));
  }
  objects.push_back(variable(0x1014, 0, Type::u32, 0x80 + node, Access::read_only));
  objects.push_back(constant(0x1029, 0, Type::u8, 1));
  Object behaviour = variable(0x1029, 1, Type::u8, 0);
  behaviour.high = 2;
  objects.push_back(behaviour);
}

void add_services(std::vector<Object>& objects, std::uint8_t node) {
  objects.push_back(variable(0x1005, 0, Type::u32, 0x80));
  objects.push_back(variable(0x1006, 0, Type::u32, 0));
  for (std::uint16_t index : {std::uint16_t{0x1010}, std::uint16_t{0x1011}}) {
    objects.push_back(constant(index, 0, Type::u8, 1));
    objects.push_back(variable(index, 1, Type::u32, 1));  // bit 0: on command
  }
  objects.push_back(constant(0x1016, 0, Type::u8, consumer_count));
  for (std::size_t i = 1; i <= consumer_count; ++i) objects.push_back(variable(0x1016, static_cast<std::uint8_t>(i), Type::u32, 0));
  objects.push_back(variable(0x1017, 0, Type::u16, 0));
  objects.push_back(constant(0x1200, 0, Type::u8, 2));
  objects.push_back(constant(0x1200, 1, Type::u32, 0x600 + node));
  objects.push_back(constant(0x1200, 2, Type::u32, 0x580 + node));
}

void add_pdo(std::vector<Object>& objects, std::uint16_t communication, std::uint32_t cob_id, const std::vector<std::uint32_t>& entries) {
  const bool transmits = communication >= 0x1800;
  const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
  objects.push_back(constant(communication, 0, Type::u8, 5));
  objects.push_back(variable(communication, 1, Type::u32, cob_id | (entries.empty() ? invalid_pdo : 0)));
  objects.push_back(variable(communication, 2, Type::u8, default_type));
  objects.push_back(variable(communication, 3, Type::u16, transmits ? default_inhibit_100us : 0));
  objects.push_back(variable(communication, 5, Type::u16, 0));
  objects.push_back(variable(mapping, 0, Type::u8, static_cast<std::int64_t>(entries.size())));
  for (std::size_t i = 0; i < max_mapped; ++i) {
    objects.push_back(variable(mapping, static_cast<std::uint8_t>(i + 1), Type::u32, i < entries.size() ? entries[i] : 0));
  }
}

}  // namespace

std::vector<Object> communication_objects(std::uint8_t node, std::uint32_t device_type, const std::string& name, const PdoDefaults& pdos) {
  std::vector<Object> objects;
  add_dummies(objects);
  add_identity(objects, node, device_type, name);
  add_errors(objects, node);
  add_services(objects, node);
  for (std::size_t i = 0; i < pdo_count; ++i) {
    const auto step = static_cast<std::uint32_t>(0x100 * i);
    add_pdo(objects, at(0x1400, i), 0x200 + step + node, pdos.receive[i]);
    add_pdo(objects, at(0x1800, i), (0x180 + step + node) | no_remote, pdos.transmit[i]);
  }
  return objects;
}

}  // namespace lf::devices
