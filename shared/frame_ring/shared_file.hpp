// A file of fixed size that another process has open, too; or, as User Mode Linux's /dev/mmapper, another kernel.
#pragma once

#include <cstddef>
#include <string>

namespace lf {

class SharedFile {
 public:
  SharedFile() = default;
  ~SharedFile() { close(); }
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  // Opens `path` for reading and writing. A regular file is made if need be and grown to `bytes`, never shrunk, so that a mapping of the other side stays
  // whole; a device is taken as it is. 0, or errno.
  int open(const std::string& path, std::size_t bytes);
  void close();
  bool is_open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }

  // Copies `bytes` from `offset` on. 0, or errno: ENODATA when the file ends before. Another process may shorten the file at any time: read() then answers
  // with an error, while a mapping of the file ends the process by SIGBUS.
  int read(void* to, std::size_t offset, std::size_t bytes) const;

 private:
  int descriptor_ = -1;
};

}  // namespace lf
