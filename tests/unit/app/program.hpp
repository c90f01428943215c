// Runs the `lanternfish` program and takes what it says.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace lf::app {

struct Said {
  int status = -1;  // exit status; 128 + n when a signal n ended it
  std::string out;
  std::string err;
};

// A folder of its own for each test, gone with it; the program runs in it.
class Program : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("lanternfish_") + info->name() + "_" + std::to_string(getpid());
    for (char& c : name) c = c == '/' ? '_' : c;
    folder_ = std::filesystem::temp_directory_path() / name;
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder() const { return folder_; }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  static std::string text_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  // `arguments` as a shell takes them; `before` stands before the program's name ("LANTERNFISH_SHARE=x", "timeout -s INT 1").
  Said run(const std::string& arguments, const std::string& before = "") const {
    const std::string command =
        "cd '" + folder_.string() + "' && " + before + " " LANTERNFISH_PROGRAM " " + arguments + " >.stdout 2>.stderr </dev/null";
    const int status = std::system(command.c_str());
    Said said;
    said.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    said.out = text_of(folder_ / ".stdout");
    said.err = text_of(folder_ / ".stderr");
    return said;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace lf::app
