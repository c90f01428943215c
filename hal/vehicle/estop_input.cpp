#include "hal/vehicle/estop_input.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <string_view>

namespace lf::hal {

EstopReading read_estop(const std::string& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return EstopReading::neither;
  std::array<char, 3> text{};  // a digit, a newline, and one more that must not be there
  std::size_t length = 0;
  ssize_t got = 1;
  while (got > 0 && length < text.size()) {
    got = read(fd, text.data() + length, text.size() - length);
    if (got > 0) length += static_cast<std::size_t>(got);
  }
  close(fd);
  if (got < 0) return EstopReading::neither;
  const std::string_view said(text.data(), length);
  if (said == "1" || said == "1\n") return EstopReading::closed;
  return said == "0" || said == "0\n" ? EstopReading::open : EstopReading::neither;
}

bool EstopInput::closed() const { return path_.empty() || read_estop(path_) == EstopReading::closed; }

}  // namespace lf::hal
