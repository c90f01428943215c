// Small text files, whole.
#pragma once

#include <filesystem>
#include <string>

namespace lf::config {

// Throws InputError: missing, a folder, unreadable, or larger than the 1 MB that no scenario, calibration or file of limits comes near.
std::string read_text_file(const std::filesystem::path& path);

}  // namespace lf::config
