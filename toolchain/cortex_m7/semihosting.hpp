// The host's console, files and exit status for a program on a bare Cortex-M7, by Arm's semihosting (Arm IHI 0053): QEMU and debug probes serve it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lf::m7 {

void print(const char* text);
void print_hex(std::uint32_t value);
// `value` with `decimals` digits after the point, right-aligned in `width` columns. Up to 1e15.
void print_number(double value, int decimals = 0, int width = 0);
// As 1.2e-13; two digits.
void print_small(double value);

// The program ends with this exit status.
[[noreturn]] void exit(int status);
[[noreturn]] void fail(const char* why);

// The command line's word number `index` (0 is the program's name), cut to the buffer; false when there is none.
bool argument(int index, char* buffer, std::size_t capacity);

// A file of the host, read from its beginning through a buffer of its own.
class HostFile {
 public:
  explicit HostFile(const char* path);
  ~HostFile();
  HostFile(const HostFile&) = delete;
  HostFile& operator=(const HostFile&) = delete;

  bool open() const { return handle_ >= 0; }
  // False when the file ends before `bytes`.
  bool read(void* into, std::size_t bytes);

 private:
  int handle_;
  std::size_t begin_ = 0, end_ = 0;
  std::uint8_t buffer_[4096];
};

}  // namespace lf::m7
