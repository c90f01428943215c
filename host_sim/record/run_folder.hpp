// The folder that a run leaves behind.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "host_sim/record/file_sink.hpp"

namespace lf::record {

class RunFolder {
 public:
  // Creates the folder and its parents, and proves that files can be made in it. An existing folder is used again.
  // Throws InputError when that is impossible.
  explicit RunFolder(const std::filesystem::path& directory);

  const std::filesystem::path& path() const { return directory_; }
  // `name` may lie in a subfolder ("images/still.png"), which is created. Throws InputError for a name that leaves the folder.
  std::filesystem::path file(const std::string& name) const;

  // Whole files, atomically. Throws as write_file_atomically.
  void write(const std::string& name, std::string_view bytes) const;
  void write(const std::string& name, std::span<const std::uint8_t> bytes) const;

 private:
  std::filesystem::path directory_;
};

}  // namespace lf::record
