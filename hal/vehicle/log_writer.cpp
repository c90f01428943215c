#include "hal/vehicle/log_writer.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "hal/vehicle/realtime.hpp"
#include "hal/vehicle/tick_clock.hpp"
#include "shared/candump/candump_line.hpp"

namespace lf::hal {

namespace {

constexpr Duration look_again = Duration::from_ms(20);
constexpr Duration flush_period = Duration::from_ms(500);
// Three times what a bus of 1 Mbit/s brings between two looks. On a disk that takes less than comes the ring is never empty, and the lines get their turn.
constexpr int frames_a_look = 512;
constexpr std::size_t most_lines = 4096;
// NTP slews the monotonic clock as well, so that the difference changes only where the wall clock is set.
constexpr std::int64_t step_ns = 1'000'000;

RotatingFile::Config file_of(const LogWriter::Config& config, const char* name) {
  return {config.folder + "/" + name, config.largest_bytes, config.keep, config.pack};
}

}  // namespace

LogWriter::LogWriter(LogRings& log, const Config& config, LinuxCalls& calls)
    : log_(log), config_(config), calls_(calls), frames_(file_of(config, "can0.log")), lines_(file_of(config, "log.jsonl")) {}

int LogWriter::open() {
  std::error_code error;
  std::filesystem::create_directories(config_.folder, error);
  if (error) return error.value();
  wall_from_monotonic_ = Duration::from_ns(calls_.realtime_ns() - calls_.monotonic_ns());
  if (const int frames = frames_.open(); frames != 0) return frames;
  return lines_.open();
}

void LogWriter::start() {
  thread_ = std::thread([this] { run(); });
}

void LogWriter::stop() {
  if (thread_.joinable()) {
    stop_ = true;
    thread_.join();
    while (write_frames() == frames_a_look) {
    }
    write_lines();
  }
  note(frames_.close());
  note(lines_.close());
}

void LogWriter::run() {
  name_thread("writer");
  Time next_flush = monotonic_now() + flush_period;
  while (!stop_) {
    follow_wall_clock();
    write_lines();
    write_frames();
    if (monotonic_now() >= next_flush) {
      note(lines_.flush());
      note(frames_.flush());
      error_ = std::exchange(round_error_, 0);
      next_flush = monotonic_now() + flush_period;
    }
    sleep_until(monotonic_now() + look_again);
  }
}

void LogWriter::note(int error) {
  if (error == 0) return;
  round_error_ = error;
  error_ = error;
}

// A vehicle's computer often starts with a wrong time and is told the right one later.
void LogWriter::follow_wall_clock() {
  const Duration now = Duration::from_ns(calls_.realtime_ns() - calls_.monotonic_ns());
  const std::int64_t change_ns = now.ns() - wall_from_monotonic_.ns();
  if (change_ns > -step_ns && change_ns < step_ns) return;
  wall_from_monotonic_ = now;
  say({{"t_s", 1e-9 * static_cast<double>(calls_.monotonic_ns())},
       {"kind", "wall clock set"},
       {"by_s", 1e-9 * static_cast<double>(change_ns)}});
}

int LogWriter::write_frames() {
  LogFrame frame;
  int written = 0;
  for (; written < frames_a_look && log_.frames.pop(frame); ++written) {
    const CandumpLine line = candump_line(frame.t + wall_from_monotonic_, config_.interface.c_str(), frame.frame);
    note(frames_.write({line.text.data(), line.size}));
  }
  return written;
}

void LogWriter::write_lines() {
  std::vector<std::string> lines;
  {
    const std::lock_guard lock(mutex_);
    lines.swap(said_);
  }
  for (const std::string& line : lines) note(lines_.write(line));
}

void LogWriter::say(const Json& line) {
  std::string text = line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  const std::lock_guard lock(mutex_);
  if (said_.size() >= most_lines) {
    ++lines_lost_;
    return;
  }
  said_.push_back(std::move(text));
}

std::string LogWriter::trouble() const {
  const int error = error_;
  return error == 0 ? "" : std::string("the log is not written: ") + std::strerror(error);
}

}  // namespace lf::hal
