#include "tests/unit/can_map/eds_file.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <stdexcept>

namespace lf::test {

namespace {

const std::set<std::string> access_types{"ro", "wo", "rw", "rwr", "rww", "const"};

std::string hex4(std::uint16_t index) {
  char text[8];
  std::snprintf(text, sizeof text, "%04X", index);
  return text;
}

}  // namespace

EdsFile::EdsFile(const std::string& path) {
  read(path);
  check_file_info(path);
  for (const auto& [name, section] : sections_) {
    if (std::regex_match(name, std::regex("[0-9A-F]{4}"))) read_object(static_cast<std::uint16_t>(std::stoul(name, nullptr, 16)));
  }
  check_lists();
}

void EdsFile::read(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path + " cannot be opened");
  Section* section = nullptr;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line.back() != '\r') complain("a line does not end with CR LF: " + line);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.size() > 255) complain("a line is longer than 255 characters");
    if (line.empty() || line[0] == ';') continue;
    if (line[0] == '[' && line.back() == ']') {
      const std::string name = line.substr(1, line.size() - 2);
      if (sections_.count(name) != 0) complain("section " + name + " stands twice");
      section = &sections_[name];
      continue;
    }
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos || section == nullptr) {
      complain("no keyword=value: " + line);
      continue;
    }
    if (!section->emplace(line.substr(0, equals), line.substr(equals + 1)).second) complain("a key stands twice: " + line);
  }
}

const std::string& EdsFile::value(const std::string& section, const std::string& key) const {
  static const std::string none;
  const auto found = sections_.find(section);
  if (found == sections_.end()) return none;
  const auto entry = found->second.find(key);
  return entry == found->second.end() ? none : entry->second;
}

std::int64_t EdsFile::number(const std::string& text, int node) {
  constexpr const char* id = "$NODEID";
  if (text.rfind(id, 0) == 0) {
    const std::string rest = text.substr(7);
    return node + (rest.empty() ? 0 : std::stoll(rest.substr(1), nullptr, 0));
  }
  return std::stoll(text, nullptr, 0);
}

void EdsFile::check_file_info(const std::string& path) {
  if (value("FileInfo", "FileName") != std::filesystem::path(path).filename()) complain("FileInfo: FileName is not the file's name");
  for (const char* key : {"FileVersion", "FileRevision"}) {
    if (!std::regex_match(value("FileInfo", key), std::regex("\\d{1,3}"))) complain(std::string("FileInfo: ") + key + " is no number");
  }
  if (value("FileInfo", "EDSVersion") != "4.0") complain("FileInfo: EDSVersion is not 4.0");
  for (const char* key : {"CreationDate", "ModificationDate"}) {
    if (!std::regex_match(value("FileInfo", key), std::regex("(0\\d|1[0-2])-[0-3]\\d-\\d{4}")))
      complain(std::string(key) + " is not mm-dd-yyyy");
  }
  for (const char* key : {"CreationTime", "ModificationTime"}) {
    if (!std::regex_match(value("FileInfo", key), std::regex("\\d\\d:\\d\\d(AM|PM)"))) complain(std::string(key) + " is not hh:mmAM|PM");
  }
  for (const char* key : {"VendorNumber", "ProductNumber", "RevisionNumber", "BaudRate_1000", "SimpleBootUpMaster", "SimpleBootUpSlave",
                          "Granularity", "GroupMessaging", "NrOfRXPDO", "NrOfTXPDO", "LSS_Supported", "DynamicChannelsSupported"}) {
    if (value("DeviceInfo", key).empty()) complain(std::string("DeviceInfo: no ") + key);
  }
}

EdsEntry EdsFile::read_entry(const std::string& section) {
  EdsEntry entry;
  entry.name = value(section, "ParameterName");
  if (entry.name.empty() || entry.name.size() > 241) complain(section + ": no ParameterName of 1 to 241 characters");
  entry.object_type = static_cast<int>(number(value(section, "ObjectType").empty() ? "7" : value(section, "ObjectType"), 0));
  if (entry.object_type == 8 || entry.object_type == 9) {
    entry.sub_number = static_cast<int>(number(value(section, "SubNumber").empty() ? "-1" : value(section, "SubNumber"), 0));
    return entry;
  }
  if (entry.object_type != 7) complain(section + ": ObjectType is none of VAR, ARRAY, RECORD");
  entry.data_type = static_cast<int>(number(value(section, "DataType").empty() ? "0" : value(section, "DataType"), 0));
  if (entry.data_type < 2 || entry.data_type > 9 || entry.data_type == 8) complain(section + ": DataType is none that we use");
  entry.access = value(section, "AccessType");
  if (access_types.count(entry.access) == 0) complain(section + ": AccessType " + entry.access);
  entry.value = value(section, "DefaultValue");
  if (!entry.text() && entry.value.empty()) complain(section + ": no DefaultValue");
  const std::string& mapping = value(section, "PDOMapping");
  if (mapping != "0" && mapping != "1") complain(section + ": PDOMapping is neither 0 nor 1");
  entry.mappable = mapping == "1";
  entry.has_low = !value(section, "LowLimit").empty();
  entry.has_high = !value(section, "HighLimit").empty();
  if (entry.has_low) entry.low = number(value(section, "LowLimit"), 0);
  if (entry.has_high) entry.high = number(value(section, "HighLimit"), 0);
  if (entry.has_low && entry.has_high && entry.low > entry.high) complain(section + ": LowLimit above HighLimit");
  return entry;
}

void EdsFile::read_object(std::uint16_t index) {
  const std::string name = hex4(index);
  const EdsEntry object = read_entry(name);
  if (object.object_type == 7) {
    entries_[std::uint32_t{index} << 8] = object;
    return;
  }
  int subs = 0;
  for (int sub = 0; sub < 256; ++sub) {
    char section[16];
    std::snprintf(section, sizeof section, "%ssub%X", name.c_str(), static_cast<unsigned>(sub));
    if (sections_.count(section) == 0) continue;
    ++subs;
    entries_[(std::uint32_t{index} << 8) | static_cast<std::uint32_t>(sub)] = read_entry(section);
  }
  if (subs != object.sub_number) complain(name + ": SubNumber is not the number of its sub-indices");
  if (entries_.count(std::uint32_t{index} << 8) == 0) complain(name + ": has no sub-index 0");
}

void EdsFile::check_lists() {
  std::set<std::uint16_t> listed;
  const auto belongs = [](const std::string& list, std::uint16_t index) {
    const bool mandatory = index == 0x1000 || index == 0x1001 || index == 0x1018;
    const bool maker = index >= 0x2000 && index < 0x6000;
    return list == "MandatoryObjects" ? mandatory : list == "ManufacturerObjects" ? maker : !mandatory && !maker;
  };
  for (const std::string list : {"MandatoryObjects", "OptionalObjects", "ManufacturerObjects"}) {
    const auto count = static_cast<std::size_t>(number(value(list, "SupportedObjects").empty() ? "0" : value(list, "SupportedObjects"), 0));
    if (sections_[list].size() != count + 1) complain(list + ": SupportedObjects is not the number of its lines");
    for (std::size_t i = 1; i <= count; ++i) {
      const auto index =
          static_cast<std::uint16_t>(number(value(list, std::to_string(i)).empty() ? "0" : value(list, std::to_string(i)), 0));
      if (sections_.count(hex4(index)) == 0) complain(list + ": " + hex4(index) + " has no section");
      if (!belongs(list, index)) complain(list + ": " + hex4(index) + " belongs in another list");
      if (!listed.insert(index).second) complain(hex4(index) + " is listed twice");
    }
  }
  for (const std::uint16_t index : {0x1000, 0x1001, 0x1018}) {
    if (listed.count(index) == 0) complain(hex4(index) + " is mandatory");
  }
  for (const auto& [key, entry] : entries_) {
    if (listed.count(static_cast<std::uint16_t>(key >> 8)) == 0) complain(hex4(static_cast<std::uint16_t>(key >> 8)) + " is in no list");
  }
}

}  // namespace lf::test
