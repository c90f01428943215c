// A scenario file for one test, gone with it.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "host_sim/scenario/instance.hpp"
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

// What load_scenario says of a bad one, or before a run check_runnable, less the file's name; "" when it is taken.
inline std::string complaint(const std::string& text, const std::vector<std::string>& overrides = {}, bool before_a_run = false) {
  const ScenarioFile file(text);
  try {
    const Scenario scenario = load_scenario(file.path(), overrides);
    if (before_a_run) check_runnable(scenario);
    return "";
  } catch (const InputError& error) {
    std::string message = error.what();
    if (message.starts_with(file.path())) message = message.substr(file.path().size());
    return message;
  }
}

inline std::string complaint_before_a_run(const std::string& text) { return complaint(text, {}, true); }

}  // namespace lf::scenario
