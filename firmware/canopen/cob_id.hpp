// Identifiers of the predefined connection set (CiA 301, 7.3.5): a function code in bits 7-10, a node in bits 0-6.
#pragma once

#include <cstdint>

namespace lf::canopen::cob_id {

inline constexpr std::uint32_t nmt = 0x000;
inline constexpr std::uint32_t sync = 0x080;
inline constexpr std::uint32_t emcy = 0x080;  // + node, and so on
inline constexpr std::uint32_t tpdo1 = 0x180;
inline constexpr std::uint32_t rpdo1 = 0x200;
inline constexpr std::uint32_t tpdo2 = 0x280;
inline constexpr std::uint32_t rpdo2 = 0x300;
inline constexpr std::uint32_t tpdo3 = 0x380;
inline constexpr std::uint32_t rpdo3 = 0x400;
inline constexpr std::uint32_t tpdo4 = 0x480;
inline constexpr std::uint32_t rpdo4 = 0x500;
inline constexpr std::uint32_t sdo_answer = 0x580;
inline constexpr std::uint32_t sdo_request = 0x600;
inline constexpr std::uint32_t heartbeat = 0x700;

// In objects 14xx:01 and 18xx:01.
inline constexpr std::uint32_t pdo_invalid = 0x80000000u;
inline constexpr std::uint32_t pdo_no_remote = 0x40000000u;  // TPDO: not to be asked for by remote frames

constexpr std::uint32_t function_of(std::uint32_t id) { return id & 0x780u; }
constexpr std::uint8_t node_of(std::uint32_t id) { return static_cast<std::uint8_t>(id & 0x7Fu); }

}  // namespace lf::canopen::cob_id
