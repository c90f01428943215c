#include "host_sim/record/run_folder.hpp"

#include <cerrno>
#include <system_error>

#include "shared/input_error.hpp"

namespace lf::record {
namespace fs = std::filesystem;

RunFolder::RunFolder(const fs::path& directory) : directory_(directory) {
  std::error_code error;
  if (fs::exists(directory, error) && !fs::is_directory(directory, error))
    throw InputError(directory.string(), 0, "is a file, not a folder");
  fs::create_directories(directory, error);
  if (error == std::errc::no_space_on_device) throw RecordError(directory.string() + ": " + error.message());
  if (error) throw InputError(directory.string(), 0, "cannot be made a folder: " + error.message() + "; --out names another");
  const fs::path probe = directory / ".writable";
  try {
    const FileSink opened(probe);
  } catch (const InputError&) {
    if (errno == ENOSPC || errno == EDQUOT) throw RecordError(directory.string() + ": " + std::generic_category().message(errno));
    throw;
  }
  fs::remove(probe, error);
}

fs::path RunFolder::file(const std::string& name) const {
  const fs::path relative = fs::path(name).lexically_normal();
  if (relative.empty() || relative.is_absolute() || *relative.begin() == "..") {
    throw InputError(name, 0, "lies outside of the run's folder");
  }
  fs::path path = directory_ / relative;
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) throw InputError(path.parent_path().string(), 0, "cannot be made a folder: " + error.message());
  return path;
}

void RunFolder::write(const std::string& name, std::string_view bytes) const { write_file_atomically(file(name), bytes); }

void RunFolder::write(const std::string& name, std::span<const std::uint8_t> bytes) const {
  write(name, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace lf::record
