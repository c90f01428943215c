// SHA-256 over everything a run did: equal digests mean equal runs.
//
// Each entry is hashed with its kind, time and length in front, so that two different histories cannot run into the same bytes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::record {

enum class CanDirection : std::uint8_t { to_devices = 0, to_core = 1 };

class RunDigest {
 public:
  RunDigest();
  ~RunDigest();
  RunDigest(RunDigest&&) noexcept;
  RunDigest& operator=(RunDigest&&) noexcept;

  void can_frame(Time t, std::uint8_t bus, CanDirection direction, const CanFrame& frame);
  void decision(Time t, std::string_view text);
  // A number of the final state, by its bits; -0 counts as 0.
  void state(std::string_view name, double value);
  void state(std::string_view name, std::span<const double> values);

  // 64 lower-case hex digits of all that came so far; more may follow.
  std::string hex() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

// Of one piece of bytes.
std::string sha256_hex(std::string_view bytes);

}  // namespace lf::record
