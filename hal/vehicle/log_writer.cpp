#include "hal/vehicle/log_writer.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "hal/vehicle/linux_calls.hpp"
#include "hal/vehicle/realtime.hpp"
#include "shared/candump/candump_line.hpp"

namespace lf::hal {

namespace {

constexpr Duration look_again = Duration::from_ms(20);
constexpr int looks_a_flush = 25;  // twice a second

}  // namespace

LogWriter::LogWriter(LogRings& log, LoopRings& loops, std::string interface) : log_(log), loops_(loops), interface_(std::move(interface)) {}

int LogWriter::open(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return error.value();
  files_.frames = std::fopen((folder + "/can0.log").c_str(), "ae");
  if (files_.frames == nullptr) return errno;
  files_.lines = std::fopen((folder + "/log.jsonl").c_str(), "ae");
  if (files_.lines == nullptr) return errno;
  wall_from_monotonic_ = Duration::from_ns(linux_calls().realtime_ns() - linux_calls().monotonic_ns());
  return 0;
}

void LogWriter::start() {
  thread_ = std::thread([this] { run(); });
}

void LogWriter::stop() {
  if (thread_.joinable()) {
    stop_ = true;
    thread_.join();
    drain();
    write_counters();
  }
  close_files();
}

void LogWriter::close_files() {
  for (std::FILE** file : {&files_.frames, &files_.lines}) {
    if (*file != nullptr && std::fclose(*file) != 0 && error_ == 0) error_ = errno;
    *file = nullptr;
  }
}

void LogWriter::run() {
  name_thread("writer");
  for (int look = 1; !stop_; ++look) {
    drain();
    if (look % looks_a_flush == 0) {
      write_counters();
      (void)std::fflush(files_.frames);
      (void)std::fflush(files_.lines);
    }
    sleep_until(monotonic_now() + look_again);
  }
}

void LogWriter::drain() {
  for (LogFrame frame; log_.frames.pop(frame);) {
    const CandumpLine line = candump_line(frame.t + wall_from_monotonic_, interface_.c_str(), frame.frame);
    if (files_.frames != nullptr && std::fwrite(line.text.data(), 1, line.size, files_.frames) != line.size) {
      const std::lock_guard lock(mutex_);
      if (error_ == 0) error_ = errno;
    }
  }
  for (Telemetry telemetry; log_.telemetry.pop(telemetry);) {
    for (const Event& event : telemetry.events) say(event_json(event));
    const std::lock_guard lock(mutex_);
    newest_.telemetry = telemetry;
  }
  for (ControlReport report; loops_.reports.pop(report);) {
    const std::lock_guard lock(mutex_);
    newest_.control = report;
  }
  for (CameraReport report; loops_.cameras.pop(report);) {
    const std::lock_guard lock(mutex_);
    newest_.camera = report;
  }
}

// When something was counted since: at most twice a second, whatever happens.
void LogWriter::write_counters() {
  const Newest now = newest();
  Json counters = counters_json(now.control, now.camera, now.telemetry);
  counters.erase("images");  // those that are well are no news
  if (counters == counters_) return;
  counters_ = counters;
  say({{"t_s", now.control.t.s()}, {"kind", "counted"}, {"counters", counters}});
}

void LogWriter::say(const Json& line) {
  const std::string text = line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  const std::lock_guard lock(mutex_);
  if (files_.lines != nullptr && std::fwrite(text.data(), 1, text.size(), files_.lines) != text.size() && error_ == 0) error_ = errno;
}

LogWriter::Newest LogWriter::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

std::string LogWriter::trouble() const {
  const std::lock_guard lock(mutex_);
  return error_ == 0 ? "" : std::string("the log is not written: ") + std::strerror(error_);
}

}  // namespace lf::hal
