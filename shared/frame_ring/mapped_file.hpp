// A shared file (shared_file.hpp) in memory, for who writes it.
//
// A mapping ends its process by SIGBUS when another process shortens the file. Who must not end so reads with SharedFile::read.
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

  // Opens `path` as SharedFile does and maps `bytes` of it for reading and writing; `bytes` is a multiple of the page size. 0, or errno: EINVAL for a size
  // that does not fit.
  int open(const std::string& path, std::size_t bytes);
  void close();
  bool is_open() const { return data_ != nullptr; }
  std::span<std::byte> bytes() const { return {data_, size_}; }

 private:
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace lf
