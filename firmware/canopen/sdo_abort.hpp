// SDO abort codes (CiA 301, 7.2.4.3.17) and their names.
#pragma once

#include <array>
#include <cstdint>

namespace lf::canopen::sdo_abort {

struct Entry {
  std::uint32_t code;
  const char* name;
};

inline constexpr std::uint32_t toggle = 0x05030000;
inline constexpr std::uint32_t timeout = 0x05040000;
inline constexpr std::uint32_t command = 0x05040001;
inline constexpr std::uint32_t out_of_memory = 0x05040005;
inline constexpr std::uint32_t read_only = 0x06010002;
inline constexpr std::uint32_t no_object = 0x06020000;
inline constexpr std::uint32_t length = 0x06070010;
inline constexpr std::uint32_t length_high = 0x06070012;
inline constexpr std::uint32_t no_sub_index = 0x06090011;
inline constexpr std::uint32_t bad_value = 0x06090030;
inline constexpr std::uint32_t too_high = 0x06090031;
inline constexpr std::uint32_t too_low = 0x06090032;
inline constexpr std::uint32_t general = 0x08000000;

inline constexpr std::array<Entry, 31> table{{
    {0x05030000, "toggle bit not alternated"},
    {0x05040000, "SDO protocol timed out"},
    {0x05040001, "command specifier not valid or unknown"},
    {0x05040002, "invalid block size"},
    {0x05040003, "invalid sequence number"},
    {0x05040004, "CRC error"},
    {0x05040005, "out of memory"},
    {0x06010000, "unsupported access to an object"},
    {0x06010001, "attempt to read a write-only object"},
    {0x06010002, "attempt to write a read-only object"},
    {0x06020000, "object does not exist"},
    {0x06040041, "object cannot be mapped to the PDO"},
    {0x06040042, "mapped objects would exceed the PDO's length"},
    {0x06040043, "general parameter incompatibility"},
    {0x06040047, "general internal incompatibility in the device"},
    {0x06060000, "access failed because of a hardware error"},
    {0x06070010, "data type or length of the parameter does not match"},
    {0x06070012, "length of the parameter too high"},
    {0x06070013, "length of the parameter too low"},
    {0x06090011, "sub-index does not exist"},
    {0x06090030, "invalid value for the parameter"},
    {0x06090031, "value of the parameter too high"},
    {0x06090032, "value of the parameter too low"},
    {0x06090036, "maximum value is less than minimum value"},
    {0x060A0023, "resource not available: SDO connection"},
    {0x08000000, "general error"},
    {0x08000020, "data cannot be transferred or stored"},
    {0x08000021, "data cannot be stored because of local control"},
    {0x08000022, "data cannot be stored because of the device's state"},
    {0x08000023, "object dictionary missing or could not be generated"},
    {0x08000024, "no data available"},
}};

// "unknown abort code" for one the standard does not have.
constexpr const char* name(std::uint32_t code) {
  for (const Entry& entry : table) {
    if (entry.code == code) return entry.name;
  }
  return "unknown abort code";
}

}  // namespace lf::canopen::sdo_abort
