// A folder of files for one test, and what is said of a bad one.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "shared/input_error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::vision::test {

class VisionFiles : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_ / name; }
  std::string write(const std::string& name, const std::string& bytes) const { return folder_.write(name, bytes); }
  static std::string bytes_of(const std::string& file_path) {
    std::ifstream file(file_path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  template <class Act>
  static std::string refusal(const Act& act) {
    return lf::test::message_of<InputError>(act);
  }

  const lf::test::TemporaryFolder folder_;
};

}  // namespace lf::vision::test
