#include "host_sim/devices/drive/drive_dictionary.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "host_sim/devices/drive/drive_habits.hpp"
#include "shared/input_error.hpp"
#include "shared/unreadable_file.hpp"

namespace lf::devices {
namespace {

Type type_of(const std::string& word, const std::string& file, int line) {
  constexpr std::pair<const char*, Type> words[] = {{"u8", Type::u8}, {"u16", Type::u16}, {"u32", Type::u32},
                                                    {"i8", Type::i8}, {"i16", Type::i16}, {"i32", Type::i32}};
  for (const auto& [name, type] : words) {
    if (word == name) return type;
  }
  throw InputError(file, line, "no type '" + word + "'");
}

Access access_of(const std::string& word) {
  if (word == "const") return Access::constant;
  if (word == "ro") return Access::read_only;
  return word == "wo" ? Access::write_only : Access::read_write;
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> all(1);
  for (const char c : line) {
    if (c == ',')
      all.emplace_back();
    else if (c != '\r')
      all.back() += c;
  }
  return all;
}

int bits_of(Type type) { return static_cast<int>(8 * size_of(type)); }
bool is_signed(Type type) { return type == Type::i8 || type == Type::i16 || type == Type::i32; }

// "$NODEID+0x200", "0x80", "-3": false for an empty cell. Hex digits of a signed object are its bits.
bool number(const std::string& cell, std::uint8_t node, Type type, std::int64_t& value) {
  std::string text = cell;
  const std::size_t plus = text.find('+');
  const bool of_node = plus != std::string::npos;
  if (of_node) text = text.substr(plus + 1);
  if (text.empty()) return false;
  const bool negative = text.front() == '-';
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  const char* begin = text.data() + (negative ? 1 : hex ? 2 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value, hex ? 16 : 10);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  if (negative) value = -value;
  if (hex && is_signed(type) && ((value >> (bits_of(type) - 1)) & 1) != 0) value -= std::int64_t{1} << bits_of(type);
  if (of_node) value += node;
  return true;
}

bool is_pdo_communication(std::uint16_t index) { return (index & 0xFFFC) == 0x1400 || (index & 0xFFFC) == 0x1800; }

Object object_of(const DictionaryRow& row, const DriveConfig& config) {
  Object object{.index = row.index, .sub = row.sub, .type = row.type, .access = row.access};
  (void)number(row.value, config.node, row.type, object.value);
  (void)number(row.low, config.node, row.type, object.low);
  (void)number(row.high, config.node, row.type, object.high);
  if (object.low > object.high) std::swap(object.low, object.high);
  if (row.mappable) object.mapping = object.writable() ? Mapping::both : Mapping::transmit;
  // One vendor's sheet bounds 1016 to 16 bits, which leaves no room for a node.
  if (row.index == 0x1016) object.low = std::numeric_limits<std::int64_t>::min(), object.high = std::numeric_limits<std::int64_t>::max();
  // A drive that somebody configured carries that project's node number: it is this one's here.
  constexpr std::int64_t id_bits = 0x7F;
  const bool identifier = (is_pdo_communication(row.index) && row.sub == 1) || row.index == 0x1014;
  if (identifier && row.value.find('+') == std::string::npos && (object.value & 0x7FF) != 0)
    object.value = (object.value & ~id_bits) | config.node;
  return object;
}

// What the sheets leave open, and drives nevertheless hold.
void fill(Object& object, const DictionaryRow& row, const DriveConfig& config) {
  const DriveHabit& habit = *config.habit;
  const bool silent = row.value.empty();
  if (object.index == 0x1000 && silent) object.value = 0x00020192;
  if (object.index == 0x1014 && silent) object.value = 0x80 + config.node;
  if (object.index == 0x1018 && object.sub == 1 && silent) object.value = habit.vendor;
  if (object.index == 0x1018 && object.sub == 2 && silent) object.value = habit.product;
  if (object.index == 0x60C2 && object.sub == 2 && silent) object.value = object.writable() ? 0 : -3;
  if (object.index != 0x6076) return;
  if (habit.rating == Rating::computed_unm) object.value = std::llround(1e6 * config.rated_torque_nm);
  if (habit.rating == Rating::stated_mnm) object.value = std::llround(1e3 * config.rated_torque_nm);
}

}  // namespace

std::shared_ptr<const DriveDictionary> read_dictionary(const std::filesystem::path& file, const std::string& drive) {
  std::ifstream in(file);
  if (!in) throw unreadable(file);
  auto rows = std::make_shared<DriveDictionary>();
  std::string line;
  int count = 0;
  while (std::getline(in, line)) {
    ++count;
    const std::vector<std::string> cell = cells(line);
    if (cell.size() < 9 || cell[0] != drive) continue;
    DictionaryRow row;
    row.index = static_cast<std::uint16_t>(std::stoul(cell[1], nullptr, 16));
    row.sub = static_cast<std::uint8_t>(std::stoul(cell[2], nullptr, 16));
    row.type = type_of(cell[3], file.string(), count);
    row.access = access_of(cell[4]);
    row.low = cell[5];
    row.high = cell[6];
    row.value = cell[7];
    row.mappable = cell[8] == "1";
    rows->push_back(row);
  }
  if (rows->empty()) throw InputError(file.string() + ": has no drive '" + drive + "'");
  return rows;
}

std::vector<Object> strict_objects(const DriveConfig& config, const std::vector<Object>& native) {
  std::map<std::uint32_t, Object> all;
  const auto key = [](std::uint16_t index, std::uint8_t sub) { return (std::uint32_t{index} << 8) | sub; };
  for (Object object : native) {
    if (object.index >= 0x2000) continue;
    // The node works with these; over the bus they are not there. Every node has 1001, and a name.
    object.absent = object.index >= 0x1000 && object.index != 0x1001 && object.index != 0x1008;
    if (is_pdo_communication(object.index)) object.value = object.sub == 1 ? std::int64_t{0x80000000} : 0;
    all[key(object.index, object.sub)] = object;
  }
  for (const DictionaryRow& row : *config.dictionary) {
    Object object = object_of(row, config);
    fill(object, row, config);
    all[key(row.index, row.sub)] = object;
  }
  std::vector<Object> objects;
  objects.reserve(all.size());
  for (auto& [place, object] : all) objects.push_back(std::move(object));
  return objects;
}

}  // namespace lf::devices
