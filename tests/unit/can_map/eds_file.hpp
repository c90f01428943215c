// An electronic data sheet as a tool reads it, written from CiA 306-1 and not from our generator.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lf::test {

struct EdsEntry {
  std::string name;
  int object_type = 0;  // 7 VAR, 8 ARRAY, 9 RECORD
  int data_type = 0;    // 2 3 4 signed, 5 6 7 unsigned, 9 visible string
  std::string access;   // ro wo rw rwr rww const
  std::string value;    // as it stands there
  bool mappable = false;
  bool has_low = false, has_high = false;
  std::int64_t low = 0, high = 0;
  int sub_number = -1;  // of an ARRAY or RECORD

  bool text() const { return data_type == 9; }
  std::size_t bytes() const { return text() ? 0 : std::size_t{1} << ((data_type - 2) % 3); }
  bool is_signed() const { return data_type < 5; }
};

class EdsFile {
 public:
  using Section = std::map<std::string, std::string>;

  explicit EdsFile(const std::string& path);

  // What CiA 306 asks for and the file has not; empty for a valid file.
  const std::vector<std::string>& complaints() const { return complaints_; }
  // By index << 8 | sub; ARRAYs and RECORDs have their sub-indices only.
  const std::map<std::uint32_t, EdsEntry>& entries() const { return entries_; }
  const std::string& value(const std::string& section, const std::string& key) const;

  // A number as it stands in an EDS: decimal, 0x hexadecimal, $NODEID plus a number.
  static std::int64_t number(const std::string& text, int node);

 private:
  void read(const std::string& path);
  void read_object(std::uint16_t index);
  EdsEntry read_entry(const std::string& section);
  void check_lists();
  void check_file_info(const std::string& path);
  void complain(const std::string& what) { complaints_.push_back(what); }

  std::map<std::string, Section> sections_;
  std::map<std::uint32_t, EdsEntry> entries_;
  std::vector<std::string> complaints_;
};

}  // namespace lf::test
