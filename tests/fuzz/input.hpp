// What the fuzz targets share: the input read piece by piece, checks, and a file that is only in memory.
//
// A target is a function of some bytes, LLVMFuzzerTestOneInput. It may refuse them; it must not crash, hang, leak, or break a check.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace lf::fuzz {

// Ends the program: libFuzzer and replay.cpp keep the input.
inline void expect(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: does not hold: %s\n", what);
  std::abort();
}

// Numbers are little-endian. Past the end everything is 0.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  bool empty() const { return rest_.empty(); }
  std::span<const std::uint8_t> rest() const { return rest_; }

  template <class Number>
  Number take() {
    Number value{};
    const std::size_t bytes = rest_.size() < sizeof value ? rest_.size() : sizeof value;
    if (bytes > 0) std::memcpy(&value, rest_.data(), bytes);
    rest_ = rest_.subspan(bytes);
    return value;
  }
  std::uint8_t byte() { return take<std::uint8_t>(); }

 private:
  std::span<const std::uint8_t> rest_;
};

// A file without a disk, for readers that take a path. One for the whole program.
class MemoryFile {
 public:
  MemoryFile();
  // Fills the file and gives its path.
  std::string holding(std::span<const std::uint8_t> bytes);
  std::string path() const;

 private:
  int fd_ = -1;
};

}  // namespace lf::fuzz
