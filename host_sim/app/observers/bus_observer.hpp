// The bus of a run: its log, its part of the digest, and how much passed.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/observers/run_files.hpp"
#include "host_sim/record/candump_log.hpp"
#include "host_sim/record/digest.hpp"

namespace lf::app {

class BusObserver : public hal::SimObserver {
 public:
  // Both outlive the observer.
  BusObserver(RunFiles& files, record::RunDigest& digest);

  void on_bus_frame(const devices::BusRecord& record) override;
  void finish();

  std::uint64_t bits() const { return bits_; }  // of delivered frames, with their stuff bits and interframe space

 private:
  RunFiles& files_;
  record::RunDigest& digest_;
  std::optional<record::CandumpLog> log_;
  std::uint64_t bits_ = 0;
};

}  // namespace lf::app
