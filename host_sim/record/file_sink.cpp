#include "host_sim/record/file_sink.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "shared/input_error.hpp"

namespace lf::record {
namespace {

std::string cause(int error_number) { return std::generic_category().message(error_number); }

}  // namespace

FileSink::FileSink(const std::filesystem::path& path) : FileSink(path, path) {}

FileSink::FileSink(const std::filesystem::path& path, const std::filesystem::path& shown)
    : path_(shown), file_(std::fopen(path.c_str(), "wb")) {
  if (file_ == nullptr) throw InputError(shown.string(), 0, "cannot be written: " + cause(errno));
}

FileSink::~FileSink() { close(); }

FileSink::FileSink(FileSink&& other) noexcept
    : path_(std::move(other.path_)), file_(std::exchange(other.file_, nullptr)), error_number_(other.error_number_) {}

FileSink& FileSink::operator=(FileSink&& other) noexcept {
  if (this != &other) {
    close();
    path_ = std::move(other.path_);
    file_ = std::exchange(other.file_, nullptr);
    error_number_ = other.error_number_;
  }
  return *this;
}

bool FileSink::write(std::string_view bytes) noexcept {
  if (file_ == nullptr || !ok()) return false;
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) error_number_ = errno != 0 ? errno : EIO;
  return ok();
}

bool FileSink::flush() noexcept {
  if (file_ == nullptr || !ok()) return ok();
  errno = 0;
  if (std::fflush(file_) != 0) error_number_ = errno != 0 ? errno : EIO;
  return ok();
}

bool FileSink::close() noexcept {
  if (file_ == nullptr) return ok();
  errno = 0;
  // After a failed write the buffer cannot be flushed either: the first cause stays.
  if (std::fclose(std::exchange(file_, nullptr)) != 0 && ok()) error_number_ = errno != 0 ? errno : EIO;
  return ok();
}

std::string FileSink::error() const { return ok() ? "" : path_.string() + ": " + cause(error_number_); }

void write_file_atomically(const std::filesystem::path& named, std::string_view bytes) {
  std::error_code unknown;
  // What a link leads to is written, and the link stays.
  const bool is_link = std::filesystem::is_symlink(named, unknown);
  const std::filesystem::path path = is_link ? std::filesystem::weakly_canonical(named, unknown) : named;
  const std::filesystem::file_status there = std::filesystem::status(path, unknown);
  if (std::filesystem::is_directory(there)) throw InputError(named.string(), 0, "is a folder, not a file");
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there))
    throw InputError(named.string(), 0, "is there and no regular file: it would be replaced");
  std::filesystem::path partial = path;
  partial += ".partial";
  FileSink sink(partial, path);
  sink.write(bytes);
  std::error_code error;
  if (!sink.close()) {
    std::filesystem::remove(partial, error);
    throw RecordError(sink.error());
  }
  std::filesystem::rename(partial, path, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw RecordError(path.string() + ": " + error.message());
  }
}

}  // namespace lf::record
