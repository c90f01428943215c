// The files of a run, and the first that could not be written.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "host_sim/record/run_folder.hpp"

namespace lf::app {

class RunFiles {
 public:
  // `folder` may be null: then nothing is written. It outlives this.
  explicit RunFiles(const record::RunFolder* folder) : folder_(folder) {}

  bool wanted() const { return folder_ != nullptr; }
  std::string path(const std::string& name) const { return folder_->file(name); }
  // Nothing more is written after the first failure: the disk is full.
  void write(const std::string& name, std::span<const std::uint8_t> bytes) {
    attempt([&] { folder_->write(name, bytes); });
  }
  void write(const std::string& name, std::string_view bytes) {
    attempt([&] { folder_->write(name, bytes); });
  }
  void lost(const std::string& cause) {
    if (error_.empty()) error_ = cause;
  }
  const std::string& error() const { return error_; }

 private:
  template <class Write>
  void attempt(Write write) {
    if (folder_ == nullptr || !error_.empty()) return;
    try {
      write();
    } catch (const record::RecordError& error) {
      error_ = error.what();
    }
  }

  const record::RunFolder* folder_;
  std::string error_;
};

}  // namespace lf::app
