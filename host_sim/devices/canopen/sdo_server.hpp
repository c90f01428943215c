// The server's side of SDO (CiA 301, 7.2.4): expedited and segmented upload and download. Block transfer is refused.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host_sim/devices/canopen/object_dictionary.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::devices {

// What an SDO reads and writes.
class SdoTarget {
 public:
  virtual ~SdoTarget() = default;
  virtual Abort sdo_read(std::uint16_t index, std::uint8_t sub, std::vector<std::uint8_t>& bytes) = 0;
  // Before the segments of a download: may it be written at all, and is `size` (0 unknown) right?
  virtual Abort sdo_may_write(std::uint16_t index, std::uint8_t sub, std::size_t size) = 0;
  virtual Abort sdo_write(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> bytes, Time now) = 0;
};

class SdoServer {
 public:
  static constexpr Duration segment_timeout = Duration::from_ms(1000);
  static constexpr std::size_t max_download = 256;  // bytes; the longest object here is a name

  explicit SdoServer(SdoTarget& target) : target_(target) {}

  // Answers 8 bytes to the request's 8. False when there is nothing to answer: an abort, or a request of other length than 8.
  bool on_request(std::span<const std::uint8_t> request, Time now, std::array<std::uint8_t, 8>& answer);
  // True when a segmented transfer ran out of time: `answer` is the abort to send.
  bool expired(Time now, std::array<std::uint8_t, 8>& answer);
  void reset() { transfer_ = Transfer::none; }

 private:
  enum class Transfer : std::uint8_t { none, upload, download };
  using Answer = std::array<std::uint8_t, 8>;

  Abort begin_upload(Answer& answer);
  Abort upload_segment(std::uint8_t command, Answer& answer);
  Abort begin_download(std::span<const std::uint8_t> request, Time now, Answer& answer);
  Abort download_segment(std::span<const std::uint8_t> request, Time now, Answer& answer);
  void abort(Abort code, Answer& answer);
  void name_object(Answer& answer) const;

  SdoTarget& target_;
  Transfer transfer_ = Transfer::none;
  std::uint16_t index_ = 0;
  std::uint8_t sub_ = 0;
  std::vector<std::uint8_t> bytes_;
  std::size_t position_ = 0;   // upload: bytes sent
  std::size_t announced_ = 0;  // download: bytes the client said would come; 0 unknown
  bool toggle_ = false;
  Time last_;
};

}  // namespace lf::devices
