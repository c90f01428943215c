// The writer thread: can0.log (candump's format, wall-clock time) and log.jsonl (one JSON object a line), both set aside when they are full.
//
// A disk that fails or is slow costs records, which are counted. It delays nobody: no lock is held while something is written.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "hal/vehicle/linux_calls.hpp"
#include "hal/vehicle/rotating_file.hpp"
#include "hal/vehicle/status_json.hpp"
#include "hal/vehicle/vehicle_platform.hpp"

namespace lf::hal {

class LogWriter {
 public:
  struct Config {
    std::string folder;
    std::string interface;
    std::int64_t largest_bytes = std::int64_t{256} << 20;  // of each file
    int keep = 24;
    bool pack = true;
  };

  LogWriter(LogRings& log, const Config& config, LinuxCalls& calls = linux_calls());
  ~LogWriter() { stop(); }
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  // Opens can0.log and log.jsonl in the folder, made if need be, behind what is in them. 0 or errno.
  int open();
  void start();
  // Writes what is left and closes. The second call does nothing.
  void stop();

  // A line for people and tools, from any thread: {"t_s", "kind", ...}. Takes as long as a copy; beyond 4096 lines that wait it is lost and counted.
  void say(const Json& line);
  // Of the latest try to write. Empty when that went well.
  std::string trouble() const;
  std::uint64_t lines_lost() const { return lines_lost_; }

 private:
  void run();
  // As many as one look takes at most; returns how many there were.
  int write_frames();
  void write_lines();
  void follow_wall_clock();
  void note(int error);

  LogRings& log_;
  Config config_;
  LinuxCalls& calls_;
  RotatingFile frames_, lines_;
  Duration wall_from_monotonic_;
  int round_error_ = 0;  // since the last flush
  std::thread thread_;
  std::atomic<bool> stop_{false};
  std::atomic<int> error_{0};
  std::atomic<std::uint64_t> lines_lost_{0};
  std::mutex mutex_;  // over `said_`
  std::vector<std::string> said_;
};

}  // namespace lf::hal
