#include "host_sim/devices/canopen/communication_objects.hpp"

namespace lf::devices {
namespace {

void add_dummies(std::vector<Object>& objects) {
  constexpr Type types[] = {Type::i8, Type::i16, Type::i32, Type::u8, Type::u16, Type::u32};
  for (std::size_t i = 0; i < 6; ++i) {
    objects.push_back({.index = static_cast<std::uint16_t>(2 + i),
                       .sub = 0,
                       .type = types[i],
                       .access = Access::write_only,
                       .mapping = Mapping::receive});
  }
}

}  // namespace

std::vector<Object> node_objects(std::span<const can_map::ObjectRow> rows, std::uint8_t node, const std::string& title,
                                 const std::function<std::int64_t(can_map::Figure)>& figure) {
  const auto number = [&](const can_map::Number& n) {
    if (n.figure == can_map::Figure::none) return n.plus;
    return (n.figure == can_map::Figure::node ? std::int64_t{node} : figure(n.figure)) + n.plus;
  };
  std::vector<Object> objects;
  add_dummies(objects);
  for (const can_map::ObjectRow& row : rows) {
    Object object{.index = row.index, .sub = row.sub, .type = row.type, .access = row.access, .mapping = row.mapping};
    object.value = number(row.value);
    object.low = number(row.low);
    object.high = number(row.high);
    if (row.type == Type::text) object.text = row.text == can_map::own_title ? title : row.text;
    object.text_capacity = row.text_capacity;
    objects.push_back(std::move(object));
  }
  return objects;
}

}  // namespace lf::devices
