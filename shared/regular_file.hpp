// The bytes of a file that a user names. Hosted side only.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "shared/input_error.hpp"
#include "shared/unreadable_file.hpp"

namespace lf {

// All of them, or the first `most_bytes + 1` of a larger file. Throws InputError for what is no regular file, which might not end, and for what cannot be read.
inline std::string bytes_of_regular_file(const std::string& file, std::size_t most_bytes) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    if (std::filesystem::exists(file, error) && !std::filesystem::is_directory(file, error))
      throw InputError(file, 0, "is no regular file: copy it into one");
    throw unreadable(file);
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw unreadable(file);
  std::string bytes;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (!error) bytes.reserve(static_cast<std::size_t>(std::min<std::uintmax_t>(size, most_bytes + 1)));
  std::array<char, 65536> piece{};
  while (bytes.size() <= most_bytes && (stream.read(piece.data(), piece.size()) || stream.gcount() > 0))
    bytes.append(piece.data(), std::min(static_cast<std::size_t>(stream.gcount()), most_bytes + 1 - bytes.size()));
  return bytes;
}

}  // namespace lf
