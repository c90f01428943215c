#include "hal/config/text_file.hpp"

#include <fstream>
#include <iterator>
#include <system_error>

#include "shared/input_error.hpp"

namespace lf::config {

namespace fs = std::filesystem;

std::string read_text_file(const fs::path& path) {
  constexpr std::uintmax_t largest = 1u << 20;
  std::error_code error;
  if (fs::is_directory(path, error)) throw InputError(path.string() + ": is a folder");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw InputError(path.string() + ": " + error.message());
  if (size > largest) throw InputError(path.string() + ": larger than 1 MB, this cannot be meant");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string() + ": cannot be opened");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) throw InputError(path.string() + ": cannot be read");
  return text;
}

}  // namespace lf::config
