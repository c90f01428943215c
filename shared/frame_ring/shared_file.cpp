#include "shared/frame_ring/shared_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace lf {

namespace {

// Regular files get the size they need; devices have theirs.
int make_room(int fd, std::size_t bytes) {
  struct stat status {};
  if (fstat(fd, &status) != 0) return errno;
  if (S_ISDIR(status.st_mode)) return EISDIR;
  if (!S_ISREG(status.st_mode) || static_cast<std::size_t>(status.st_size) >= bytes) return 0;
  // Its blocks, too: a write to a hole of a full disk would kill the writer.
  const int error = posix_fallocate(fd, 0, static_cast<off_t>(bytes));
  if (error != EOPNOTSUPP && error != EINVAL) return error;
  return ftruncate(fd, static_cast<off_t>(bytes)) == 0 ? 0 : errno;
}

}  // namespace

int SharedFile::open(const std::string& path, std::size_t bytes) {
  close();
  // Without O_CREAT first: with it, a file of somebody else's in a sticky folder is refused (fs.protected_regular).
  int fd = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (fd < 0 && errno == ENOENT) fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0660);
  if (fd < 0) return errno;
  const int error = make_room(fd, bytes);
  if (error != 0) {
    ::close(fd);
    return error;
  }
  descriptor_ = fd;
  return 0;
}

void SharedFile::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

int SharedFile::read(void* to, std::size_t offset, std::size_t bytes) const {
  auto* place = static_cast<std::byte*>(to);
  while (bytes > 0) {
    const ssize_t got = pread(descriptor_, place, bytes, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno;
    if (got == 0) return ENODATA;
    place += got;
    offset += static_cast<std::size_t>(got);
    bytes -= static_cast<std::size_t>(got);
  }
  return 0;
}

}  // namespace lf
