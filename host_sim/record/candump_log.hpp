// CAN traffic as can-utils' `candump -l` writes it: canplayer, python-can, SavvyCAN and Wireshark open it.
//
//   (0000000012.004000) can0 181#37064F0B00001200
//
// Time is the simulated one in seconds. Standard identifiers have 3 hex digits, extended and error frames 8; a remote frame is #R and its length.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "host_sim/record/file_sink.hpp"
#include "shared/messages/can_frame.hpp"
#include "shared/messages/time.hpp"

namespace lf::record {

// One line with its newline. Times before zero are written as zero.
std::string candump_line(Time t, const std::string& interface, const CanFrame& frame);

class CandumpLog {
 public:
  // Throws InputError when the file cannot be opened.
  explicit CandumpLog(const std::filesystem::path& path, std::string interface = "can0");

  // Never throws; after a failed write nothing more is written and sink().error() has the cause.
  bool write(Time t, const CanFrame& frame) noexcept;
  bool close() noexcept { return sink_.close(); }
  std::uint64_t frames() const { return frames_; }
  const FileSink& sink() const { return sink_; }

 private:
  FileSink sink_;
  std::string interface_;
  std::uint64_t frames_ = 0;
};

}  // namespace lf::record
