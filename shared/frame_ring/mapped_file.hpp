// A file of fixed size in memory, shared with another process or, as User Mode Linux's /dev/mmapper, with another kernel.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace lf {

class MappedFile {
 public:
  MappedFile() = default;
  ~MappedFile() { close(); }
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  // Maps `bytes` of `path` for reading and writing; `bytes` is a multiple of the page size. A regular file is made if need be and grown to `bytes`,
  // never shrunk, so that a mapping of the other side stays whole; a device is taken as it is. 0, or errno: EINVAL for a size that does not fit.
  int open(const std::string& path, std::size_t bytes);
  void close();
  bool is_open() const { return data_ != nullptr; }
  std::span<std::byte> bytes() const { return {data_, size_}; }

 private:
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace lf
