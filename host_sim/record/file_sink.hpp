// A file being written that keeps what it has when the disk fills up.
#pragma once

#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace lf::record {

// What was to be recorded could not be: full disk, quota, a device that went away. One line; exit status 3, the environment lacks something.
class RecordError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Buffered writing. The first failure sticks: later writes do nothing, what reached the disk stays, and `error()` tells the cause.
class FileSink {
 public:
  // Truncates or creates. Throws InputError when the file cannot be opened.
  explicit FileSink(const std::filesystem::path& path);
  // `shown`: the name that messages have, of a file that is going to be renamed.
  FileSink(const std::filesystem::path& path, const std::filesystem::path& shown);
  ~FileSink();  // flushes; a failure is lost here, so close() first where it matters
  FileSink(FileSink&& other) noexcept;
  FileSink& operator=(FileSink&& other) noexcept;

  // False once a write has failed. Never throws.
  bool write(std::string_view bytes) noexcept;
  bool flush() noexcept;
  // Flushes and closes; false when anything was lost. Further calls repeat the answer.
  bool close() noexcept;

  bool ok() const { return error_number_ == 0; }
  // "can0.log: No space left on device", empty when all is well.
  std::string error() const;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::FILE* file_ = nullptr;
  int error_number_ = 0;
};

// Writes a whole file beside its final name and renames it there, so that a reader never sees half of it.
// A link stays, and what it leads to is written. Throws InputError when it cannot be opened and for what is there and no regular file, RecordError when it cannot be written; the half-written one is removed.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace lf::record
