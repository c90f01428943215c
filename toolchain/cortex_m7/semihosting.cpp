#include "toolchain/cortex_m7/semihosting.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lf::m7 {
namespace {

// Operation numbers of Arm IHI 0053.
constexpr int sys_open = 0x01, sys_close = 0x02, sys_write0 = 0x04, sys_read = 0x06, sys_get_cmdline = 0x15, sys_exit_extended = 0x20;
constexpr std::uintptr_t mode_read_binary = 1;
constexpr std::uintptr_t stopped_application_exit = 0x20026;

int call(int operation, const void* arguments) {
  register int r0 asm("r0") = operation;
  register const void* r1 asm("r1") = arguments;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

}  // namespace

void print(const char* text) { call(sys_write0, text); }

void print_hex(std::uint32_t value) {
  char text[11] = "0x00000000";
  for (int i = 9; i > 1; --i, value >>= 4) text[i] = "0123456789abcdef"[value & 15];
  print(text);
}

void print_number(double value, int decimals, int width) {
  double scale = 1;
  for (int i = 0; i < decimals; ++i) scale *= 10;
  std::uint64_t digits = static_cast<std::uint64_t>(std::llround(std::abs(value) * scale));
  char text[48];
  char* front = text + sizeof text;
  *--front = 0;
  for (int i = 0; i <= decimals || digits > 0; ++i) {
    if (i == decimals && decimals > 0) *--front = '.';
    *--front = static_cast<char>('0' + digits % 10);
    digits /= 10;
  }
  if (value < 0) *--front = '-';
  while (text + sizeof text - 1 - front < width && front > text) *--front = ' ';
  print(front);
}

void print_small(double value) {
  if (value == 0) return print("0");
  int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  double mantissa = value / std::pow(10.0, exponent);
  if (std::abs(mantissa) >= 9.95) {
    mantissa /= 10;
    ++exponent;
  }
  print_number(mantissa, 1);
  print("e");
  print_number(exponent);
}

void exit(int status) {
  const std::uintptr_t arguments[2] = {stopped_application_exit, static_cast<std::uintptr_t>(status)};
  for (;;) call(sys_exit_extended, arguments);
}

void fail(const char* why) {
  print(why);
  print("\n");
  exit(3);
}

bool argument(int index, char* buffer, std::size_t capacity) {
  char line[1024];
  std::uintptr_t arguments[2] = {reinterpret_cast<std::uintptr_t>(line), sizeof line};
  if (call(sys_get_cmdline, arguments) != 0) return false;
  const char* word = line;
  for (; index > 0; --index) {
    word = std::strchr(word, ' ');
    if (word == nullptr) return false;
    ++word;
  }
  const char* end = std::strchr(word, ' ');
  const std::size_t length = end != nullptr ? static_cast<std::size_t>(end - word) : std::strlen(word);
  if (length == 0 || length >= capacity) return false;
  std::memcpy(buffer, word, length);
  buffer[length] = 0;
  return true;
}

HostFile::HostFile(const char* path) {
  const std::uintptr_t arguments[3] = {reinterpret_cast<std::uintptr_t>(path), mode_read_binary, std::strlen(path)};
  handle_ = call(sys_open, arguments);
}

HostFile::~HostFile() {
  const std::uintptr_t arguments[1] = {static_cast<std::uintptr_t>(handle_)};
  if (open()) call(sys_close, arguments);
}

bool HostFile::read(void* into, std::size_t bytes) {
  auto* out = static_cast<std::uint8_t*>(into);
  while (bytes > 0) {
    if (begin_ == end_) {
      const std::uintptr_t arguments[3] = {static_cast<std::uintptr_t>(handle_), reinterpret_cast<std::uintptr_t>(buffer_), sizeof buffer_};
      const int missing = call(sys_read, arguments);  // of the buffer's size
      if (missing < 0 || missing >= static_cast<int>(sizeof buffer_)) return false;
      begin_ = 0;
      end_ = sizeof buffer_ - static_cast<std::size_t>(missing);
    }
    const std::size_t n = std::min(bytes, end_ - begin_);
    std::memcpy(out, buffer_ + begin_, n);
    begin_ += n;
    out += n;
    bytes -= n;
  }
  return true;
}

}  // namespace lf::m7
