#include "host_sim/serve/serve_orders.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <sstream>

#include "host_sim/scenario/instance.hpp"
#include "shared/input_error.hpp"

namespace lf::serve {

namespace {

constexpr Duration for_ever = Duration::from_ms(1'000'000'000);

double seconds(const std::string& word) {
  std::istringstream stream(word);
  double value = -1;
  if (!(stream >> value) || !stream.eof() || !(value >= 0) || value > 1e6) throw InputError("'" + word + "' is no number of seconds");
  return value;
}

void trouble_camera(std::istringstream& words, ServeLoop& loop) {
  static constexpr std::array<std::pair<const char*, CameraTrouble>, 4> troubles{
      {{"freeze", CameraTrouble::freeze}, {"drop", CameraTrouble::drop}, {"repeat", CameraTrouble::repeat}, {"away", CameraTrouble::away}}};
  std::string what, time;
  words >> what >> time;
  if (loop.camera() == nullptr) throw InputError("there is no camera");
  for (const auto& [name, trouble] : troubles) {
    if (what != name) continue;
    loop.camera()->set_trouble(trouble, loop.simulated() + (time.empty() ? for_ever : Duration::from_s(seconds(time))));
    return;
  }
  throw InputError("camera takes freeze, drop, repeat or away");
}

bool is_number(const std::string& word) { return word.find_first_not_of("0123456789.") == std::string::npos; }

void make_fault(std::istringstream& words, ServeLoop& loop) {
  scenario::Fault fault;
  words >> fault.kind;
  for (std::string word; words >> word;) {
    if (word.starts_with("0x")) {
      fault.can_id = static_cast<std::int64_t>(std::strtoul(word.c_str(), nullptr, 16));
    } else if (is_number(word)) {
      fault.duration_s = seconds(word);
    } else {
      fault.node = word;
    }
  }
  config::Drives drives;
  for (std::size_t i = 0; i < loop.rack().io_slot(); ++i) drives.joints[i].node = loop.rack().node(i).id();
  drives.output_node = loop.rack().node(loop.rack().io_slot()).id();
  loop.rack().add_fault(scenario::device_fault(fault, drives, loop.joints()), loop.simulated());
}

}  // namespace

void carry_out(const std::string& line, ServeLoop& loop, const ServeLoop::Say& say) {
  std::istringstream words(line);
  std::string order;
  words >> order;
  if (order == "camera") {
    trouble_camera(words, loop);
  } else if (order == "fault") {
    make_fault(words, loop);
  } else if (order != "say") {
    throw InputError("no order '" + order + "'; there are camera, fault and say");
  }
  if (say) say("order: " + line);
}

OrderReader::OrderReader(const std::string& file) {
  if (file.empty()) return;
  // For writing, too: a FIFO without a writer would be at its end for ever.
  fd_ = ::open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) throw InputError("--orders " + file + ": " + std::strerror(errno));
}

OrderReader::~OrderReader() {
  if (fd_ >= 0) ::close(fd_);
}

void OrderReader::carry_out(ServeLoop& loop, const ServeLoop::Say& say) {
  if (fd_ < 0) return;
  std::array<char, 512> bytes;
  for (ssize_t got = 0; (got = ::read(fd_, bytes.data(), bytes.size())) > 0;) rest_.append(bytes.data(), static_cast<std::size_t>(got));
  for (std::size_t end = 0; (end = rest_.find('\n')) != std::string::npos;) {
    const std::string line = rest_.substr(0, end);
    rest_.erase(0, end + 1);
    if (line.empty()) continue;
    try {
      serve::carry_out(line, loop, say);
    } catch (const InputError& error) {
      if (say) say(std::string("order '") + line + "': " + error.what());
    }
  }
}

}  // namespace lf::serve
