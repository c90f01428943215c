// SDO client for one node: expedited and segmented upload and download (CiA 301, 7.2.4). No block transfer.
//
// One transfer at a time. Every wait is bounded: without an answer within the time-out the client sends abort 0x05040000 and fails.
// An answer about another object is refused and counted, and the wait goes on.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/canopen/sdo_abort.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::canopen {

class SdoClient {
 public:
  static constexpr std::size_t capacity = 64;  // longest value; device names (1008) are the longest in use, 33 bytes on known drives

  enum class State : std::uint8_t { idle, busy, done, failed };

  struct Stats {
    std::uint32_t transfers = 0;  // started
    std::uint32_t completed = 0;
    std::uint32_t server_aborts = 0;
    std::uint32_t timeouts = 0;
    std::uint32_t own_aborts = 0;    // sent by us, time-outs included
    std::uint32_t unexpected = 0;    // answers while idle
    std::uint32_t wrong_object = 0;  // answers about another object
  };

  SdoClient() = default;
  SdoClient(std::uint8_t node, Duration timeout) : node_(node), timeout_(timeout) {}

  // Starts a transfer; its first frame leaves with the next `poll`. False while busy, and for a download that is empty or over `capacity`.
  bool upload(std::uint16_t index, std::uint8_t sub);
  bool download(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> value);
  // The same for a number, its `width` (1, 2 or 4) low bytes.
  bool download(std::uint16_t index, std::uint8_t sub, std::uint32_t value, std::uint8_t width);

  State state() const { return state_; }
  bool busy() const { return state_ == State::busy; }
  std::uint32_t abort_code() const { return abort_code_; }  // after `failed`: the server's or our own
  bool aborted_by_server() const { return server_aborted_; }
  // After `done` of an upload. A server that does not say how many of an expedited answer's four bytes count gives all four.
  std::span<const std::uint8_t> value() const { return {buffer_.data(), size_}; }
  bool size_known() const { return size_known_; }
  std::uint32_t number() const;  // little-endian, the first four bytes of `value`

  // Gives up without telling the server: the node was reset.
  void reset();
  // An SDO answer of this node (COB-ID 0x580 + node), 8 bytes. False when it is refused: nobody waits for it, or it is about another object.
  bool on_frame(const CanFrame& frame, Time now);
  // Writes the frame that is due, if any: a request, the next segment, or an abort. Call until it returns false.
  bool poll(Time now, CanFrame& frame);

  const Stats& stats() const { return stats_; }

 private:
  enum class Phase : std::uint8_t { upload_initiate, upload_segment, download_initiate, download_segment };

  void begin(Phase phase, std::uint16_t index, std::uint8_t sub);
  void fail(std::uint32_t code);
  void abort(std::uint32_t code);
  void finish();
  bool same_object(const CanFrame& frame) const;
  void on_upload_initiated(const CanFrame& frame);
  void on_upload_segment(const CanFrame& frame);
  void on_download_initiated(const CanFrame& frame);
  void on_download_segment(const CanFrame& frame);
  void make_request(CanFrame& frame);
  void make_download_segment(CanFrame& frame);

  std::uint8_t node_ = 0;
  Duration timeout_;
  State state_ = State::idle;
  Phase phase_ = Phase::upload_initiate;
  std::uint16_t index_ = 0;
  std::uint8_t sub_ = 0;
  bool request_due_ = false;  // a frame waits for `poll`
  bool abort_due_ = false;
  bool server_aborted_ = false;
  bool size_known_ = false;
  bool toggle_ = false;
  std::uint8_t last_segment_ = 0;  // bytes in the download segment on its way
  std::uint32_t abort_code_ = 0;
  // The abort that waits for `poll`: the next transfer may already have been asked for.
  std::uint16_t aborted_index_ = 0;
  std::uint8_t aborted_sub_ = 0;
  std::uint32_t own_abort_code_ = 0;
  std::size_t size_ = 0;      // bytes of the value (download: all; upload: so far)
  std::size_t position_ = 0;  // download: acknowledged; upload: announced size, 0 if none
  Time deadline_;
  std::array<std::uint8_t, capacity> buffer_{};
  Stats stats_;
};

}  // namespace lf::canopen
