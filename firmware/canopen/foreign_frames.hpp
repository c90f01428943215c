// What another master has sent, by identifier.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lf::canopen {

// Whether the identifier is an RPDO's of the predefined connection set: function codes 0x200, 0x300, 0x400 and 0x500.
constexpr bool is_rpdo(std::uint32_t id) { return id >= 0x200 && id < 0x580 && (id & 0x80) == 0; }

// Counts the frames of the first 8 identifiers one by one, and those of all others together: their RPDOs in a slot of their own, since they are set points. A
// master that runs this arm sends 8: SYNC, its heartbeat and six RPDOs. NMT and six SDO requests come at its boot.
class ForeignFrames {
 public:
  static constexpr std::size_t named = 8;
  static constexpr std::size_t others = named;  // the slot of all other identifiers
  static constexpr std::size_t other_rpdos = named + 1;
  static constexpr std::size_t slots = named + 2;

  struct Sender {
    std::uint32_t id = 0;  // of the last two slots: of their newest frame
    std::uint32_t frames = 0;
  };

  void add(std::uint32_t id) {
    Sender& sender = senders_[slot_of(id)];
    sender.id = id;
    ++sender.frames;
  }

  // The first with `frames` 0 ends the named ones.
  const Sender& operator[](std::size_t slot) const { return senders_[slot]; }

 private:
  std::size_t slot_of(std::uint32_t id) const {
    for (std::size_t slot = 0; slot < named; ++slot) {
      if (senders_[slot].frames == 0 || senders_[slot].id == id) return slot;
    }
    return is_rpdo(id) ? other_rpdos : others;
  }

  std::array<Sender, slots> senders_{};
};

}  // namespace lf::canopen
