#include "host_sim/record/candump_log.hpp"

#include <utility>

#include "shared/candump/candump_line.hpp"

namespace lf::record {

std::string candump_line(Time t, const std::string& interface, const CanFrame& frame) {
  return std::string(lf::candump_line(t, interface.c_str(), frame).view());
}

CandumpLog::CandumpLog(const std::filesystem::path& path, std::string interface) : sink_(path), interface_(std::move(interface)) {}

bool CandumpLog::write(Time t, const CanFrame& frame) noexcept {
  if (!sink_.write(lf::candump_line(t, interface_.c_str(), frame).view())) return false;
  ++frames_;
  return true;
}

}  // namespace lf::record
