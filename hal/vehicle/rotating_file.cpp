#include "hal/vehicle/rotating_file.hpp"

#include <zlib.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

namespace lf::hal {

namespace fs = std::filesystem;

int pack_file(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> from(std::fopen(path.c_str(), "rbe"), std::fclose);
  if (from == nullptr) return errno;
  const std::string partial = path + ".gz.partial";
  gzFile to = gzopen(partial.c_str(), "wbe6");
  if (to == nullptr) return errno != 0 ? errno : ENOMEM;
  std::array<char, 65536> block{};
  bool well = true;
  for (std::size_t bytes = 1; well && bytes > 0;) {
    bytes = std::fread(block.data(), 1, block.size(), from.get());
    well = bytes == 0 || gzwrite(to, block.data(), static_cast<unsigned>(bytes)) == static_cast<int>(bytes);
  }
  well = std::ferror(from.get()) == 0 && well;
  well = gzclose(to) == Z_OK && well;
  std::error_code error;
  if (well) fs::rename(partial, path + ".gz", error);
  if (!well || error) {
    fs::remove(partial, error);
    return EIO;
  }
  fs::remove(path, error);
  return error.value();
}

int RotatingFile::open() {
  file_ = std::fopen(config_.path.c_str(), "ae");
  if (file_ == nullptr) return errno;
  std::error_code error;
  const auto bytes = fs::file_size(config_.path, error);
  bytes_ = error ? 0 : static_cast<std::int64_t>(bytes);
  return 0;
}

int RotatingFile::set_aside() {
  const auto aside = [this](int i, const char* ending) { return config_.path + "." + std::to_string(i) + ending; };
  std::error_code error;
  for (const char* ending : {"", ".gz"}) {
    fs::remove(aside(config_.keep, ending), error);
    for (int i = config_.keep - 1; i >= 1; --i) {
      if (fs::exists(aside(i, ending), error)) fs::rename(aside(i, ending), aside(i + 1, ending), error);
    }
  }
  if (std::fclose(std::exchange(file_, nullptr)) != 0) error.assign(errno, std::generic_category());
  fs::rename(config_.path, aside(1, ""), error);
  const int opened = open();
  if (config_.pack && !error) (void)worker_.post([path = aside(1, "")] { (void)pack_file(path); });
  return opened != 0 ? opened : error.value();
}

int RotatingFile::write(std::string_view text) {
  if (file_ == nullptr) {
    if (const int error = open(); error != 0) return error;
  }
  if (bytes_ >= config_.largest_bytes && worker_.idle()) {
    if (const int error = set_aside(); error != 0) return error;
  }
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) {
    const int error = errno;
    std::clearerr(file_);
    return error;
  }
  bytes_ += static_cast<std::int64_t>(text.size());
  return 0;
}

int RotatingFile::flush() { return file_ == nullptr || std::fflush(file_) == 0 ? 0 : errno; }

int RotatingFile::close() {
  if (file_ == nullptr) return 0;
  return std::fclose(std::exchange(file_, nullptr)) == 0 ? 0 : errno;
}

}  // namespace lf::hal
