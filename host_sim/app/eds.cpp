#include "host_sim/app/eds.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "shared/can/can_map.hpp"

namespace lf::app {
namespace {

using can_map::Access;
using can_map::Figure;
using can_map::Mapping;
using can_map::Number;
using can_map::ObjectHead;
using can_map::ObjectKind;
using can_map::ObjectRow;
using can_map::Type;

constexpr std::array<std::uint16_t, 3> mandatory{0x1000, 0x1001, 0x1018};
constexpr std::array<int, 8> rates_kbit_s{10, 20, 50, 125, 250, 500, 800, 1000};
constexpr int pdos_a_way = 4;  // of the predefined connection set

struct TypeWords {
  int code;  // CiA 301
  int digits;
  bool is_signed;
};

TypeWords words_of(Type type) {
  switch (type) {
    case Type::i8: return {2, 2, true};
    case Type::i16: return {3, 4, true};
    case Type::i32: return {4, 8, true};
    case Type::u8: return {5, 2, false};
    case Type::u16: return {6, 4, false};
    case Type::u32: return {7, 8, false};
    case Type::text: break;
  }
  return {9, 0, false};
}

std::string hex(std::uint64_t value, int digits) {
  std::array<char, 24> text;
  std::snprintf(text.data(), text.size(), "%0*llX", digits, static_cast<unsigned long long>(value));
  return text.data();
}

// CiA 306 says with rww in which PDOs a writable object may stand; both ways is rw.
std::string access_of(const ObjectRow& row) {
  switch (row.access) {
    case Access::constant: return "const";
    case Access::read_only: return "ro";
    case Access::write_only: return "wo";
    case Access::read_write: break;
  }
  return row.mapping == Mapping::receive ? "rww" : "rw";
}

// $NODEID stays a formula: the file serves a device that was given another number.
std::string value_of(const Number& number, const ObjectRow& row, const EdsNode& node) {
  if (number.figure == Figure::node) return number.plus == 0 ? "$NODEID" : "$NODEID+0x" + hex(static_cast<std::uint64_t>(number.plus), 1);
  const std::int64_t value = number.plus + (number.figure == Figure::none ? 0 : node.figure(number.figure));
  const TypeWords type = words_of(row.type);
  return type.is_signed || std::abs(value) < 10 ? std::to_string(value) : "0x" + hex(static_cast<std::uint64_t>(value), type.digits);
}

using Lines = std::vector<std::string>;

void add_row(const std::string& section, const ObjectRow& row, const EdsNode& node, Lines& lines) {
  lines.insert(lines.end(), {"[" + section + "]", std::string("ParameterName=") + row.name, "ObjectType=0x7",
                             "DataType=0x" + hex(static_cast<std::uint64_t>(words_of(row.type).code), 4), "AccessType=" + access_of(row)});
  if (row.type == Type::text) {
    lines.push_back("DefaultValue=" + (row.text == can_map::own_title ? node.title : std::string(row.text)));
  } else {
    lines.push_back("DefaultValue=" + value_of(row.value, row, node));
    if (row.low.plus != can_map::unlimited_low.plus) lines.push_back("LowLimit=" + value_of(row.low, row, node));
    if (row.high.plus != can_map::unlimited_high.plus) lines.push_back("HighLimit=" + value_of(row.high, row, node));
  }
  lines.insert(lines.end(), {row.mapping == Mapping::none ? "PDOMapping=0" : "PDOMapping=1", ""});
}

void add_list(const char* section, const std::vector<std::uint16_t>& indices, Lines& lines) {
  lines.insert(lines.end(), {"[" + std::string(section) + "]", "SupportedObjects=" + std::to_string(indices.size())});
  for (std::size_t i = 0; i < indices.size(); ++i) lines.push_back(std::to_string(i + 1) + "=0x" + hex(indices[i], 4));
  lines.emplace_back();
}

void add_device(const EdsNode& node, Lines& lines) {
  const can_map::Sheet sheet = can_map::sheet();
  const std::string date = sheet.date;
  lines.insert(lines.end(), {"[FileInfo]",
                             "FileName=" + node.file,
                             "FileVersion=" + std::to_string(sheet.version),
                             "FileRevision=0",
                             "EDSVersion=4.0",
                             "Description=" + node.title + ", node " + std::to_string(node.number),
                             "CreationTime=12:00AM",
                             "CreationDate=" + date,
                             "CreatedBy=Lanternfish",
                             "ModificationTime=12:00AM",
                             "ModificationDate=" + date,
                             "ModifiedBy=Lanternfish",
                             "",
                             "[DeviceInfo]",
                             std::string("VendorName=") + sheet.vendor_name,
                             "VendorNumber=0x" + hex(sheet.vendor, 8),
                             "ProductName=" + node.title,
                             "ProductNumber=0x" + hex(sheet.product, 8),
                             "RevisionNumber=0x" + hex(sheet.revision, 8),
                             "OrderCode=0"});
  for (const int rate : rates_kbit_s)
    lines.push_back("BaudRate_" + std::to_string(rate) + (1000u * static_cast<unsigned>(rate) == can_map::bitrate ? "=1" : "=0"));
  lines.insert(lines.end(), {"SimpleBootUpMaster=0", "SimpleBootUpSlave=1", "Granularity=8", "DynamicChannelsSupported=0",
                             "GroupMessaging=0", "NrOfRXPDO=" + std::to_string(pdos_a_way), "NrOfTXPDO=" + std::to_string(pdos_a_way),
                             "LSS_Supported=0", "", "[DummyUsage]", "Dummy0001=0"});
  for (int type = 2; type < 8; ++type) lines.push_back("Dummy000" + std::to_string(type) + "=1");
  lines.insert(lines.end(), {"", "[Comments]", "Lines=0", ""});
}

void add_lists(const EdsNode& node, Lines& lines) {
  std::vector<std::uint16_t> required(mandatory.begin(), mandatory.end()), optional, own;
  for (std::size_t i = 0; i < node.rows.size(); ++i) {
    const std::uint16_t index = node.rows[i].index;
    if ((i > 0 && node.rows[i - 1].index == index) || std::find(mandatory.begin(), mandatory.end(), index) != mandatory.end()) continue;
    (index >= 0x2000 && index < 0x6000 ? own : optional).push_back(index);
  }
  add_list("MandatoryObjects", required, lines);
  add_list("OptionalObjects", optional, lines);
  add_list("ManufacturerObjects", own, lines);
}

}  // namespace

std::string eds(const EdsNode& node) {
  Lines lines;
  add_device(node, lines);
  add_lists(node, lines);
  for (std::size_t first = 0; first < node.rows.size();) {
    const std::uint16_t index = node.rows[first].index;
    const auto other = [&](const ObjectRow& row) { return row.index != index; };
    const auto count =
        static_cast<std::size_t>(std::find_if(node.rows.begin() + static_cast<std::ptrdiff_t>(first), node.rows.end(), other) -
                                 node.rows.begin()) -
        first;
    const auto head = std::find_if(node.heads.begin(), node.heads.end(), [&](const ObjectHead& h) { return h.index == index; });
    if (head == node.heads.end()) {
      add_row(hex(index, 4), node.rows[first], node, lines);
    } else {
      lines.insert(lines.end(),
                   {"[" + hex(index, 4) + "]", std::string("ParameterName=") + head->name,
                    head->kind == ObjectKind::array ? "ObjectType=0x8" : "ObjectType=0x9", "SubNumber=" + std::to_string(count), ""});
      for (const ObjectRow& row : node.rows.subspan(first, count)) add_row(hex(index, 4) + "sub" + hex(row.sub, 1), row, node, lines);
    }
    first += count;
  }
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) text += (i == 0 ? "" : "\r\n") + lines[i];
  return text;
}

}  // namespace lf::app
