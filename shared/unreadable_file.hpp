// Why a file that a user names could not be opened. Hosted side only.
#pragma once

#include <filesystem>
#include <system_error>

#include "shared/input_error.hpp"

namespace lf {

inline InputError unreadable(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return InputError(path.string(), 0, "is a folder, not a file");
  if (!std::filesystem::exists(path, ignored)) return InputError(path.string(), 0, "there is no such file");
  return InputError(path.string(), 0, "cannot be read: check its permissions");
}

}  // namespace lf
