// A CANopen device as CiA 301 has it: NMT slave, SDO server, PDOs, SYNC, heartbeat both ways, emergencies. What it does is its application's.
//
//                  SDO  PDO/SYNC  EMCY  heartbeat, NMT
//   pre-operational  x              x     x
//   operational      x      x       x     x
//   stopped                               x
//   off, booting                                        (a boot-up message ends it)
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host_sim/devices/canopen/communication_objects.hpp"
#include "host_sim/devices/canopen/object_dictionary.hpp"
#include "host_sim/devices/canopen/pdo.hpp"
#include "host_sim/devices/canopen/sdo_server.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::devices {

enum class NmtState : std::uint8_t { booting = 0, stopped = 4, operational = 5, pre_operational = 127 };

// Emergency error codes used here (CiA 301 and 402), and their bits in the error register 1001.
namespace emcy {
inline constexpr std::uint16_t overcurrent = 0x2310;
inline constexpr std::uint16_t hot = 0x4210;
inline constexpr std::uint16_t stopped_by_master = 0x8100;  // generic communication: NMT took a powered drive out of operation
inline constexpr std::uint16_t heartbeat = 0x8130;
inline constexpr std::uint16_t bus_off_recovered = 0x8140;
inline constexpr std::uint16_t pdo_too_short = 0x8210;
inline constexpr std::uint16_t pdo_too_long = 0x8220;
inline constexpr std::uint16_t pdo_timeout = 0x8250;
inline constexpr std::uint16_t following = 0x8611;
inline constexpr std::uint16_t software_limit = 0x8A82;  // EPOS4
std::uint8_t register_bit(std::uint16_t code);
}  // namespace emcy

class Application {
 public:
  virtual ~Application() = default;
  virtual Abort may_write(const Object& object, std::int64_t value) = 0;  // an SDO wants to; type and limits are checked
  virtual void written(const Object& object, Time now) = 0;               // by SDO
  virtual void received(Time now) = 0;                                    // the whole of a PDO is in the dictionary
  virtual void synced(Time now) = 0;                                      // SYNC while operational, after its PDOs were received
  virtual void connection_lost(std::uint16_t code, Time now) = 0;         // 6007's cases: an emcy code from 8100 on
  virtual void state_changed(NmtState state, Time now) = 0;
  virtual void restarted(Time now) = 0;  // power-on or NMT reset node; objects have their power-on values
};

class Node : private SdoTarget {
 public:
  // `boot_time` from power to boot-up. `objects` are the application's, beside communication_objects().
  Node(std::uint8_t id, std::vector<Object> objects, Duration boot_time, Application& application);
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  void power_on(Time now);
  void receive(const CanFrame& frame, Time now);
  void tick(Time now);  // once a millisecond: boot, heartbeats, deadlines, event-driven PDOs

  // Frames to send, oldest first; the owner takes them and clears the list.
  std::vector<CanFrame>& outbox() { return outbox_; }

  std::uint8_t id() const { return id_; }
  NmtState state() const { return state_; }
  ObjectDictionary& objects() { return objects_; }
  const ObjectDictionary& objects() const { return objects_; }

  // An error appears or is gone: 1001, 1003 and an EMCY message. Each code is active once.
  void raise(std::uint16_t code, Time now);
  void clear(std::uint16_t code, Time now);
  bool active(std::uint16_t code) const;
  // Whether inhibit times hold back synchronous PDOs, too: CiA 301 leaves it to the maker.
  void set_inhibits_synchronous(bool inhibits) { inhibits_synchronous_ = inhibits; }
  // The event timers of RPDOs are objects without an effect.
  void set_ignores_deadlines(bool ignores) { ignores_deadlines_ = ignores; }
  void bus_off(Time now);        // the controller lost the bus: 6007's case
  void bus_recovered(Time now);  // and has it again: EMCY 8140

 private:
  struct Consumer {
    std::uint8_t node = 0;
    Duration timeout;
    Time last;
    bool watching = false;  // from the first heartbeat on
  };

  Abort sdo_read(std::uint16_t index, std::uint8_t sub, std::vector<std::uint8_t>& bytes) override;
  Abort sdo_may_write(std::uint16_t index, std::uint8_t sub, std::size_t size) override;
  Abort sdo_write(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> bytes, Time now) override;
  Abort check_communication(const Object& object, std::int64_t value);
  void communication_written(const Object& object, Time now);

  void boot(Time now, Duration time);
  void on_nmt(const CanFrame& frame, Time now);
  void enter(NmtState state, Time now);
  void reset_communication(Time now);
  void on_sync(Time now);
  void on_heartbeat(const CanFrame& frame, Time now);
  void on_guard_request(Time now);
  void check_guard(Time now);
  void on_sdo(const CanFrame& frame, Time now);
  bool on_pdo(const CanFrame& frame, Time now);
  void check_consumers(Time now);
  void check_deadlines(Time now);
  void send_events(Time now);
  void configure_pdos();
  void configure_consumers();
  void remember(std::uint16_t code);
  void send_emergency(std::uint16_t code);
  bool talks() const { return state_ == NmtState::operational || state_ == NmtState::pre_operational; }

  std::uint8_t id_;
  Duration boot_time_;
  ObjectDictionary objects_;
  Application& application_;
  SdoServer sdo_;
  Object& error_register_;
  Object& heartbeat_ms_;
  Object& sync_id_;
  std::array<Pdo, pdo_count> receive_, transmit_;
  std::array<Consumer, consumer_count> consumers_;
  std::vector<std::uint16_t> errors_;
  std::vector<CanFrame> outbox_;
  NmtState state_ = NmtState::booting;
  bool powered_ = false;
  bool inhibits_synchronous_ = false;
  bool ignores_deadlines_ = false;
  // Node guarding (100C, 100D): watched from the first request on.
  bool guarded_ = false;
  bool guard_toggle_ = false;
  Time last_guard_;
  Time boot_done_;
  Time next_heartbeat_;
};

}  // namespace lf::devices
