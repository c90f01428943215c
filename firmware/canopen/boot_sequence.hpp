// The boot of one node: reset communication, boot-up message, its table of objects over SDO, start.
//
//   idle -> reset -> await_boot_up -> configure -> configured -> start -> await_operational -> await_data -> done
//
// Any state may end in failed, with node, object, abort code and reason. Lost answers and missing messages are tried again a bounded number of
// times; a refusal or a wrong value is not.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/canopen/boot_plan.hpp"
#include "firmware/canopen/boot_report.hpp"
#include "firmware/canopen/sdo_client.hpp"
#include "shared/messages/time.hpp"

namespace lf::canopen {

enum class NmtCommand : std::uint8_t { start = 1, stop = 2, enter_pre_operational = 128, reset_node = 129, reset_communication = 130 };

class BootSequence {
 public:
  // 6061 follows 6060 within a few of a drive's own cycles; polled once a SYNC.
  static constexpr std::uint8_t mode_reads = 50;

  BootSequence() = default;
  explicit BootSequence(const NetworkConfig& config);

  void begin(const BootContext& context, Time now);
  void fail(BootFailure failure);
  // Once a SYNC. Starts SDO transfers and takes their results.
  void step(Time now, SdoClient& sdo, const BootContext& context);
  // False when no reset command of ours caused it: the node restarted by itself, and has lost what it keeps without power.
  bool on_boot_up(Time now, SdoClient& sdo);
  void on_operational(Time now);
  void on_process_data();
  // All nodes are configured: start this one.
  void release(Time now);
  // No longer watched or expected to answer; the report stays.
  void stand_down() { phase_ = Phase::idle; }
  // The NMT command that is due, once.
  std::optional<NmtCommand> take_nmt();

  bool configured() const { return phase_ == Phase::configured; }
  bool running() const { return report_.state == BootState::running; }
  bool done() const { return phase_ == Phase::done; }
  bool failed() const { return phase_ == Phase::failed; }
  // The node was told to start and not reset since: its process data and its heartbeat count.
  bool started() const { return phase_ >= Phase::await_operational && phase_ <= Phase::done; }
  const NodeBoot& report() const { return report_; }

 private:
  enum class Phase : std::uint8_t { idle, reset, await_boot_up, configure, configured, start, await_operational, await_data, done, failed };
  enum class Exchange : std::uint8_t { next, reading, writing, reading_back };

  void start_step(SdoClient& sdo, const BootContext& context);
  void take_result(SdoClient& sdo, const BootContext& context);
  void take_read(SdoClient& sdo, const BootContext& context);
  void take_sdo_failure(SdoClient& sdo, const BootContext& context);
  bool substituted(const BootContext& context);
  bool write_fallback(std::uint32_t code, SdoClient& sdo, const BootContext& context);
  void record(const SdoClient& sdo, const BootContext& context);
  void record_rating(std::uint32_t number, const BootContext& context);
  void await(Time now, Phase again, Duration timeout, BootFailure failure);
  void next_step();
  bool retry();

  Phase phase_ = Phase::idle;
  Exchange exchange_ = Exchange::next;
  BootStep step_;  // the row at work
  Duration boot_up_timeout_, start_timeout_;
  std::uint8_t retries_allowed_ = 0;
  std::uint8_t retries_left_ = 0;  // of the step or phase at work
  std::uint8_t mode_reads_left_ = 0;
  std::uint8_t resets_unanswered_ = 0;  // reset commands sent that no boot-up message answered yet
  bool fallback_tried_ = false;
  std::uint32_t written_ = 0;
  bool nmt_due_ = false;
  NmtCommand nmt_ = NmtCommand::reset_communication;
  Time deadline_;
  NodeBoot report_;
};

}  // namespace lf::canopen
