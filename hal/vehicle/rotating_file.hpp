// A log file that is set aside when it is full: FILE, then FILE.1.gz, FILE.2.gz ... from the youngest to the oldest, of which so many are kept.
//
// Not thread-safe: one thread owns it. Packing runs on a thread of its own; the file grows beyond its size while the one before is still being packed.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

#include "hal/vehicle/worker.hpp"

namespace lf::hal {

class RotatingFile {
 public:
  struct Config {
    std::string path;
    std::int64_t largest_bytes = std::int64_t{256} << 20;
    int keep = 24;  // files set aside; the oldest beyond them is removed
    bool pack = true;
  };

  explicit RotatingFile(const Config& config) : config_(config) {}
  ~RotatingFile() { (void)close(); }
  RotatingFile(const RotatingFile&) = delete;
  RotatingFile& operator=(const RotatingFile&) = delete;

  // Opens the file behind what is in it. 0 or errno, as all below.
  int open();
  // A text that could not be written is lost; the next is tried again.
  int write(std::string_view text);
  int flush();
  int close();
  void finish_packing() { worker_.finish(); }

 private:
  int set_aside();

  Config config_;
  std::FILE* file_ = nullptr;
  std::int64_t bytes_ = 0;
  Worker worker_{"pack"};
};

// Writes FILE.gz and removes FILE. 0 or errno; FILE stays when it fails.
int pack_file(const std::string& path);

}  // namespace lf::hal
