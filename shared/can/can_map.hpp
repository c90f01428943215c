// The CAN map: which node is what, and what its process data carry. The core and the simulated devices both stand on it.
#pragma once

#include <array>
#include <cstdint>

#include "shared/messages/joint_io.hpp"
#include "shared/messages/time.hpp"

namespace lf::can_map {

inline constexpr std::uint32_t bitrate = 1'000'000;
// 250 Hz with five drives and the output node loads the bus by about 36 % with worst-case stuffing; 500 Hz would take 71 %.
inline constexpr Duration sync_period = Duration::from_ms(4);

inline constexpr std::uint8_t master_node = 0x7F;  // the master's own heartbeat, 0x77F
inline constexpr Duration master_heartbeat = Duration::from_ms(100);
inline constexpr Duration master_heartbeat_timeout = Duration::from_ms(300);  // written to 1016:01 of every node
inline constexpr Duration node_heartbeat = Duration::from_ms(100);            // written to 1017
inline constexpr Duration node_heartbeat_timeout = Duration::from_ms(300);

// Drives, CiA 402. RPDO1: 6040 u16, 607A i32, 60B2 i16. TPDO1: 6041 u16, 6064 i32, 6077 i16. Both transmission type 1 (every SYNC).
// Positions are motor counts; torques are thousandths of the rated torque 6076 (mNm at the joint).
inline constexpr std::array<std::uint8_t, joint_count> drive_nodes{1, 2, 3, 4, 5};

// Outputs and inputs, CiA 401 with a manufacturer's camera trigger.
//   RPDO1 (0x206, type 1): 6200:01 u8 outputs, 2100:01 u8 trigger counter, 2100:02 u16 exposure in us
//   TPDO1 (0x186, type 1): 6000:01 u8 inputs, 2101:01 u8 outputs as they are, 2101:02 u8 last trigger counter, 2101:03 u16 last exposure in us
// Outputs change, and the camera is triggered, at the SYNC after the RPDO that asked for it: a changed trigger counter is one exposure.
inline constexpr std::uint8_t io_node = 6;
inline constexpr std::uint8_t output_laser = 0x01;
inline constexpr std::uint8_t output_lamps = 0x02;
inline constexpr std::uint8_t input_estop_closed = 0x01;      // the emergency-stop chain is intact: 1 is healthy, a cut wire is a stop
inline constexpr std::uint8_t input_interlock_closed = 0x02;  // the laser's interlock; open, the node itself keeps the laser off

}  // namespace lf::can_map
