#include "host_sim/app/observers/bus_observer.hpp"

#include "host_sim/devices/bus/can_bits.hpp"
#include "shared/can/can_map.hpp"

namespace lf::app {

BusObserver::BusObserver(RunFiles& files, record::RunDigest& digest) : files_(files), digest_(digest) {
  if (files_.wanted()) log_.emplace(files_.path("can0.log"));
}

void BusObserver::on_bus_frame(const devices::BusRecord& record) {
  const bool from_core = record.sender == can_map::master_node;
  digest_.can_frame(record.delivered, 0, from_core ? record::CanDirection::to_devices : record::CanDirection::to_core, record.frame);
  bits_ += devices::frame_bits(record.frame) + devices::interframe_bits;
  if (log_ && !log_->write(record.delivered, record.frame)) files_.lost(log_->sink().error());
}

void BusObserver::finish() {
  if (log_ && !log_->close()) files_.lost(log_->sink().error());
}

}  // namespace lf::app
