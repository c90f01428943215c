#include "hal/vehicle/estop_input.hpp"

#include <fcntl.h>
#include <unistd.h>

namespace lf::hal {

bool EstopInput::closed() const {
  if (path_.empty()) return true;
  const int fd = open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return false;
  char value = 0;
  const bool read_it = read(fd, &value, 1) == 1;
  close(fd);
  return read_it && value == '1';
}

}  // namespace lf::hal
