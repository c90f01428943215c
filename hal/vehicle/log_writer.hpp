// The writer thread: takes what the control and vision threads leave in the rings, keeps the newest of it for the operator, and writes can0.log (candump's
// format, wall-clock time) and log.jsonl (one JSON object a line). A disk that fails or is slow costs records, which are counted, never a control tick.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>

#include "hal/vehicle/control_loop.hpp"
#include "hal/vehicle/status_json.hpp"
#include "hal/vehicle/vehicle_platform.hpp"

namespace lf::hal {

class LogWriter {
 public:
  struct Newest {
    ControlReport control;
    CameraReport camera;
    Telemetry telemetry;
  };

  LogWriter(LogRings& log, LoopRings& loops, std::string interface);
  ~LogWriter() { stop(); }
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  // Opens can0.log and log.jsonl in `folder`, made if need be, behind what is in them. 0 or errno.
  int open(const std::string& folder);
  void start();
  // Writes what is left and closes. The second call does nothing.
  void stop();

  // A line for people and tools, from any thread: {"t_s", "kind", ...}. Lines of events come from the rings.
  void say(const Json& line);
  Newest newest() const;
  // Of a write that failed: what is said is lost from then on. Empty when all is well.
  std::string trouble() const;

 private:
  struct Files {
    std::FILE* frames = nullptr;
    std::FILE* lines = nullptr;
  };

  void run();
  void drain();
  void write_counters();
  void close_files();

  LogRings& log_;
  LoopRings& loops_;
  std::string interface_;
  Duration wall_from_monotonic_;  // when the log was opened: a jump of the wall clock does not show in it
  Files files_;
  std::thread thread_;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;  // over all below
  Newest newest_;
  Json counters_;
  int error_ = 0;
};

}  // namespace lf::hal
