// Reads a bus and says which drives are on it: which profile each has, what differs from it, and a draft of a profile for one that is not known.
//
// It only reads. SDO uploads go out, and nothing else: no NMT command, no SYNC, no write. It may run beside a master that stands still.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/canopen/sdo_client.hpp"
#include "hal/config/drive_kind.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

// An object as a node answered: its bytes, or the abort code.
struct ReadObject {
  std::vector<std::uint8_t> bytes;
  std::uint32_t abort_code = 0;
  bool there() const { return abort_code == 0; }
  std::uint32_t number() const;
};

struct FoundNode {
  std::uint8_t node = 0;
  std::map<std::uint32_t, ReadObject> objects;  // by index << 8 | sub

  const ReadObject* find(std::uint16_t index, std::uint8_t sub) const;
  bool drive() const;        // CiA 402
  std::string name() const;  // 1008
};

class BusDoctor {
 public:
  // Asks nodes `first` to `last`, one after the other. A node that does not answer within 30 ms is not there. It reads what the boot needs, and what `kinds`
  // want checked.
  explicit BusDoctor(std::uint8_t first = 1, std::uint8_t last = 126, const std::vector<config::DriveKind>& kinds = {});

  void on_frame(const CanFrame& frame, Time now);
  // Appends the frames that are due. Call it every millisecond.
  void step(Time now, std::vector<CanFrame>& out);
  bool done() const { return node_ > last_; }
  const std::vector<FoundNode>& nodes() const { return nodes_; }

 private:
  void next_node();
  void next_object();
  void take();

  std::vector<std::uint32_t> wanted_;  // index << 8 | sub
  std::uint8_t node_;
  std::uint8_t last_;
  std::size_t object_ = 0;
  canopen::SdoClient sdo_;
  FoundNode reading_;
  std::vector<FoundNode> nodes_;
};

// All of `kinds` that the drive's vendor and product allow. A profile that states the product goes before one that does not.
std::vector<const config::DriveKind*> kinds_of(const FoundNode& node, const std::vector<config::DriveKind>& kinds);

// A profile that the machine's file names for the drive of a joint.
struct ConfiguredDrive {
  std::string joint;
  config::DriveKind kind;
};
using ConfiguredDrives = std::map<std::uint8_t, ConfiguredDrive>;  // by node

// What the drive holds or lacks otherwise than its profile says, a sentence each.
std::vector<std::string> differences(const FoundNode& node, const config::DriveKind& kind);

// A profile in YAML, filled with what was read; what a reader has to state stands there as a question.
std::string draft_profile(const FoundNode& node);

// All of it, for programs: {"nodes": [...], "missing": [...], "agrees": ...}. "agrees" is false where nobody answers, and where a configured drive does
// not answer or differs from its profile.
nlohmann::ordered_json doctor_json(const std::vector<FoundNode>& nodes, const std::vector<config::DriveKind>& kinds,
                                   const ConfiguredDrives& configured = {});

// All of it, for people, with a note where a profile checks no object of the drive's units. A node that is `configured` is held against that profile, whatever it says it is.
std::string doctor_text(const std::vector<FoundNode>& nodes, const std::vector<config::DriveKind>& kinds,
                        const ConfiguredDrives& configured = {});

}  // namespace lf::hal
