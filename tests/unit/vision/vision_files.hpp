// A folder of files for one test, and what is said of a bad one.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "shared/input_error.hpp"

namespace lf::vision::test {

class VisionFiles : public testing::Test {
 protected:
  VisionFiles() {
    std::string pattern = (std::filesystem::temp_directory_path() / "lanternfish-test-XXXXXX").string();
    if (::mkdtemp(pattern.data()) != nullptr) folder_ = pattern;
  }
  ~VisionFiles() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  static std::string bytes_of(const std::string& file_path, std::size_t most = std::string::npos) {
    std::ifstream file(file_path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    return bytes.substr(0, most);
  }
  template <class Act>
  static std::string refusal(const Act& act) {
    try {
      act();
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "nothing was refused";
    return "";
  }

  std::filesystem::path folder_;
};

}  // namespace lf::vision::test
