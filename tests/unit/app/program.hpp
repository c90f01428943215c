// Runs the `lanternfish` program and takes what it says.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

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

  // `arguments` as a shell takes them; `before` stands before the program's name ("LANTERNFISH_SHARE=x").
  Said run(const std::string& arguments, const std::string& before = "") const {
    return said(std::system(command(before + " " LANTERNFISH_PROGRAM " " + arguments).c_str()));
  }

  enum class Whom { all, copies };

  // What it says with --json.
  nlohmann::json json_of(const std::string& arguments, int status = 0) const {
    const Said said = run(arguments + " --json");
    EXPECT_EQ(said.status, status) << said.err;
    return nlohmann::json::parse(said.out);  // throws, and the test fails, when anything else is on stdout
  }

  // Ctrl-C on a terminal, for the program and its children, or a signal to the children that it has by then: as soon as `file` in the folder has over `bytes`
  // bytes. Not after a time, which a busy machine passes before the program has begun.
  Said interrupt(const std::string& arguments, const std::string& file, std::uintmax_t bytes, Whom whom = Whom::all) const {
    const std::string line = command("exec " LANTERNFISH_PROGRAM " " + arguments);
    const pid_t child = fork();
    if (child == 0) {
      setpgid(0, 0);
      execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      _exit(127);
    }
    setpgid(child, child);  // whoever of the two comes first
    int status = 0;
    std::error_code ignored;
    for (int looks = 0;; ++looks) {
      if (waitpid(child, &status, WNOHANG) == child) {
        ADD_FAILURE() << "ended before " << file << " was there";
        return said(status);
      }
      const std::uintmax_t size = std::filesystem::file_size(folder_ / file, ignored);
      const bool there = !ignored && size > bytes;
      EXPECT_LT(looks, 24'000) << file << " is not there after 2 minutes";
      if (there || looks >= 24'000) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (whom == Whom::all) kill(-child, SIGINT);
    for (int looks = 0; whom == Whom::copies && looks < 1000 && signal_copies_of(child) == 0; ++looks)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    waitpid(child, &status, 0);
    return said(status);
  }

 private:
  // Returns how many there were.
  static int signal_copies_of(pid_t program) {
    const std::string id = std::to_string(program);
    std::ifstream copies("/proc/" + id + "/task/" + id + "/children");
    int signalled = 0;
    for (pid_t copy = 0; copies >> copy; ++signalled) kill(copy, SIGINT);
    return signalled;
  }
  std::string command(const std::string& words) const {
    return "cd '" + folder_.string() + "' && " + words + " >.stdout 2>.stderr </dev/null";
  }
  Said said(int status) const {
    Said said;
    said.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    said.out = text_of(folder_ / ".stdout");
    said.err = text_of(folder_ / ".stderr");
    return said;
  }

  std::filesystem::path folder_;
};

}  // namespace lf::app
