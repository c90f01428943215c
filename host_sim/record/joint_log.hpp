// What the core knew of its joints over a run, as CSV: t_s, then of each joint its angle and target in rad and its torque in N m.
// Cells are empty while the core has no valid sample of the joints, as before the drives' first answer.
//
//   t_s,slew_rad,slew_target_rad,slew_torque_nm,shoulder_rad,...
//   4.240000,0.1234567,0.1240000,3.210,...
#pragma once

#include <filesystem>

#include "firmware/telemetry.hpp"
#include "host_sim/record/file_sink.hpp"
#include "shared/arm/joint_names.hpp"

namespace lf::record {

class JointLog {
 public:
  // Throws InputError when the file cannot be opened.
  JointLog(const std::filesystem::path& path, const JointNames& joints);

  // Never throws; after a failed write nothing more is written and sink().error() has the cause.
  bool write(const Telemetry& telemetry) noexcept;
  bool close() noexcept { return sink_.close(); }
  const FileSink& sink() const { return sink_; }

 private:
  FileSink sink_;
  std::size_t joints_;
};

}  // namespace lf::record
