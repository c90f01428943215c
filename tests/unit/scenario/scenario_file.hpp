// A scenario file for one test, gone with it.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "host_sim/scenario/scenario.hpp"
#include "shared/input_error.hpp"

namespace lf::scenario {

class ScenarioFile {
 public:
  explicit ScenarioFile(const std::string& text, const std::string& ending = ".yaml") {
    std::string test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    for (char& c : test) c = c == '/' ? '_' : c;
    path_ = std::filesystem::temp_directory_path() / ("lanternfish_" + test + std::to_string(::getpid()) + ending);
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~ScenarioFile() { std::filesystem::remove(path_); }
  ScenarioFile(const ScenarioFile&) = delete;
  ScenarioFile& operator=(const ScenarioFile&) = delete;

  std::string path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// What load_scenario says of a bad one, less the file's name; "" when it takes it.
inline std::string complaint(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const ScenarioFile file(text);
  try {
    load_scenario(file.path(), overrides);
    return "";
  } catch (const InputError& error) {
    std::string message = error.what();
    if (message.starts_with(file.path())) message = message.substr(file.path().size());
    return message;
  }
}

}  // namespace lf::scenario
