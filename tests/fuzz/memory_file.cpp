#include <sys/mman.h>
#include <unistd.h>

#include "tests/fuzz/input.hpp"

namespace lf::fuzz {

MemoryFile::MemoryFile() : fd_(memfd_create("fuzz", MFD_CLOEXEC)) { expect(fd_ >= 0, "there are files in memory"); }

std::string MemoryFile::holding(std::span<const std::uint8_t> bytes) {
  const bool written = ftruncate(fd_, 0) == 0 && pwrite(fd_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size());
  expect(written, "the file in memory takes the input");
  return path();
}

std::string MemoryFile::path() const { return "/proc/self/fd/" + std::to_string(fd_); }

}  // namespace lf::fuzz
