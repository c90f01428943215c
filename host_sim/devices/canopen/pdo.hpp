// Process data objects (CiA 301, 7.2.2): the rules of their parameters, and what packs and unpacks them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "host_sim/devices/canopen/communication_objects.hpp"
#include "host_sim/devices/canopen/object_dictionary.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::devices {

// True for 1400..1403, 1600..1603, 1800..1803, 1A00..1A03.
bool is_pdo_parameter(std::uint16_t index);

// May `value` be written to a PDO parameter? The order of CiA 301: COB-ID bit 31 = 1, mapping sub 0 = 0, entries, sub 0 = n, COB-ID valid.
//   device_state             COB-ID's bits, inhibit time or mapping of a PDO that is valid
//   unsupported_access       an entry while sub 0 is not 0
//   no_object, no_sub_index  an entry, or sub 0 = n over an entry, that names nothing
//   not_mappable             ... or an object that may not stand in this PDO, or with another length
//   mapping_too_long         more than 8 entries or 64 bits
//   bad_value                reserved identifiers, 29-bit identifiers, transmission types 241 to 253
Abort check_pdo_parameter(ObjectDictionary& objects, const Object& parameter, std::int64_t value);

// One PDO as its parameters describe it now.
class Pdo {
 public:
  // `communication` is its 14xx or 18xx object. Reads all parameters anew.
  void configure(ObjectDictionary& objects, std::uint16_t communication);

  bool valid() const { return valid_; }
  std::uint16_t cob_id() const { return cob_id_; }
  bool synchronous() const { return type_ <= 240; }
  std::uint8_t type() const { return type_; }
  std::uint8_t bytes() const { return bytes_; }

  CanFrame pack() const;
  // Takes over what lies within the objects' limits; the rest keeps its value. `data` has at least `bytes()` bytes.
  void unpack(std::span<const std::uint8_t> data) const;

  // State of a received PDO.
  CanFrame held;  // synchronous: waits for the SYNC
  bool holding = false;
  bool seen = false;  // since the node is operational: starts the deadline
  bool overdue = false;
  Time last;             // received or sent
  Duration event_timer;  // deadline of a received, period of a sent PDO; 0 off
  Duration inhibit;      // sent PDO: least distance
  // State of a sent PDO.
  std::uint8_t syncs = 0;  // since the last transmission
  CanFrame previous;       // event-driven: sent when it differs

 private:
  std::array<Object*, max_mapped> mapped_{};
  std::size_t count_ = 0;
  std::uint16_t cob_id_ = 0;
  std::uint8_t type_ = 255;
  std::uint8_t bytes_ = 0;
  bool valid_ = false;
};

}  // namespace lf::devices
