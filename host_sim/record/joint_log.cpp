#include "host_sim/record/joint_log.hpp"

#include <array>
#include <cstdio>
#include <string>

namespace lf::record {

JointLog::JointLog(const std::filesystem::path& path, const JointNames& joints) : sink_(path), joints_(joints.size()) {
  std::string header = "t_s";
  for (const std::string& name : joints) {
    for (const char* what : {"_rad", "_target_rad", "_torque_nm"}) header += "," + name + what;
  }
  sink_.write(header + "\n");
}

bool JointLog::write(const Telemetry& telemetry) noexcept {
  std::array<char, 1024> line;
  int length = std::snprintf(line.data(), line.size(), "%.6f", telemetry.t.s());
  for (std::size_t i = 0; i < joints_; ++i) {
    const auto used = static_cast<std::size_t>(length);
    length += telemetry.joints_valid ? std::snprintf(line.data() + used, line.size() - used, ",%.7f,%.7f,%.3f", telemetry.actual_rad[i],
                                                     telemetry.target_rad[i], telemetry.torque_nm[i])
                                     : std::snprintf(line.data() + used, line.size() - used, ",,,");
    if (static_cast<std::size_t>(length) + 1 >= line.size()) return false;  // no number is that long
  }
  line[static_cast<std::size_t>(length)] = '\n';
  return sink_.write({line.data(), static_cast<std::size_t>(length) + 1});
}

}  // namespace lf::record
