#include "hal/vehicle/operator_client.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "hal/vehicle/daemon.hpp"

namespace lf::hal {

Json ask_daemon(const std::string& path, const Json& request) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy_n(path.begin(), std::min(path.size(), sizeof address.sun_path - 1), address.sun_path);
  const timeval patience{5, 0};
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  const std::string line = request.dump() + "\n";
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      send(fd, line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size())) {
    const int error = errno;
    close(fd);
    throw EnvironmentLacks(path + ": no lanternfishd answers there (" + std::strerror(error) + ")");
  }
  std::string text;
  std::array<char, 4096> buffer{};
  for (ssize_t bytes = 1; bytes > 0 && text.find('\n') == std::string::npos;) {
    bytes = recv(fd, buffer.data(), buffer.size(), 0);
    if (bytes > 0) text.append(buffer.data(), static_cast<std::size_t>(bytes));
  }
  close(fd);
  Json reply = Json::parse(text, nullptr, false);
  if (!reply.is_object()) throw EnvironmentLacks(path + ": lanternfishd gave no answer");
  return reply;
}

namespace {

std::string number(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string histogram_text(const Json& h) {
  return number("p50 %.0f us", h["p50"].get<double>()) + number(", p99.9 %.0f us", h["p999"].get<double>()) +
         number(", max %.0f us", h["max"].get<double>());
}

// Who presses the button to try it looks here. The node says nothing before it is in operation.
std::string chains_text(const Json& status) {
  const auto state = [&](const char* key) { return status.value(key, false) ? "closed" : "open"; };
  std::string text = "  emergency-stop chain ";
  text += status.value("inputs_fresh", false) ? std::string(state("estop_closed")) + ", laser's interlock " + state("interlock_closed")
                                              : "not heard: the output node is not in operation";
  if (status.contains("estop_input_closed")) text += std::string("; estop.input ") + state("estop_input_closed");
  return text + "\n";
}

}  // namespace

std::string commissioning_text(const Json& done) {
  std::string text;
  const Json friction = done.value("friction", Json::object());
  const Json zeros = done.value("zeros", Json::object());
  const Json moved = done.value("moved_rad", Json::object());
  for (const auto& [joint, zero] : zeros.items()) {
    char line[192];
    std::snprintf(line, sizeof line, "%-9s zero at %d counts", joint.c_str(), zero.get<int>());
    text += line;
    if (friction.contains(joint)) {
      const Json& found = friction[joint];
      std::snprintf(line, sizeof line, "; friction %.4g mN m and %.4g mN m per rad/s at the motor, residual %.4g mN m",
                    found["coulomb_mnm"].get<double>(), found["viscous_mnm_s"].get<double>(), found["rms_mnm"].get<double>());
      text += line;
    } else {
      text += "; friction not measured: as the arm's description has it";
    }
    if (moved.contains(joint)) {
      std::snprintf(
          line, sizeof line,
          "; its zero has moved by %.2f rad: if the drive and its encoder are the same as before, an obstacle was taken for the stop",
          moved[joint].get<double>());
      text += line;
    }
    text += "\n";
  }
  return text;
}

std::string status_text(const Json& status) {
  std::string text = status["standing"].get<std::string>() + ", step " + status["step"].get<std::string>() + "\n";
  if (status.contains("failure")) {
    const Json& failure = status["failure"];
    text += "  failed in " + failure["step"].get<std::string>() + ": " + failure.value("text", failure["reason"].get<std::string>()) + "\n";
  }
  if (status.contains("faults since the end")) text += "  since the end: " + status["faults since the end"].dump() + "\n";
  for (const Json& task : status["tasks"]) {
    text += "  task " + task["task"].get<std::string>();
    if (task.contains("valve")) text += " " + task["valve"].get<std::string>();
    if (task.contains("button")) text += " " + task["button"].get<std::string>();
    if (task.contains("target_deg")) text += number(" to %.1f deg", task["target_deg"].get<double>());
    text += task["done"].get<bool>() ? ": done\n" : ": not done\n";
  }
  if (status.contains("fit") && status["fit"].contains("doubt")) {
    const Json& fit = status["fit"];
    text += "  doubtful calibration: " + fit["doubt"].get<std::string>() + ". " + fit.value("remedy", "") + "\n";
  }
  for (const Json& joint : status["joints"]) {
    char line[128];
    std::snprintf(line, sizeof line, "  %-9s %-10s %8.4f rad %7.2f N m", joint["joint"].get<std::string>().c_str(),
                  joint["state"].get<std::string>().c_str(), joint["actual_rad"].get<double>(), joint["torque_nm"].get<double>());
    text += std::string(line) + (joint.contains("fault") ? "  " + joint["fault"].get<std::string>() : "") + "\n";
  }
  text += chains_text(status);
  for (const Json& node : status["nodes"]) {
    if (node.contains("why")) text += "  " + node["why"].get<std::string>() + "\n";
  }
  text += "  wake-up " + histogram_text(status["latency"]["wake_up_us"]) + "; tick " + histogram_text(status["latency"]["tick_us"]) + "\n";
  for (const Json& loss : status["lost"]) text += "  " + loss.get<std::string>() + "\n";
  for (const auto& [what, counts] : status["counters"].items()) {
    if (!counts.empty() && what != "images") text += "  counted, " + what + ": " + counts.dump() + "\n";
  }
  return text;
}

}  // namespace lf::hal
