// The output node: laser, lamps, camera trigger, and the safety inputs (CiA 401 with manufacturer's objects, see shared/can/can_map.hpp).
//
// Outputs are on only while the node is operational: a lost heartbeat, an NMT stop or a reset switches them off, unless 6206 and 6207 hold one on
// in the stopped state. The interlock gates the laser in
// hardware: open, the laser is off whatever 6200 says, and 2101:01 shows it. A changed trigger counter is one exposure of 2100:02 microseconds; an
// exposure of 0 is none. After power-on the last counter is 0.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host_sim/devices/canopen/node.hpp"
#include "host_sim/devices/devices_config.hpp"
#include "host_sim/devices/exposure.hpp"

namespace lf::devices {

class IoNode : private Application {
 public:
  IoNode(const IoConfig& config, Duration boot_time);

  Node& node() { return node_; }

  void power_on(Time now) { node_.power_on(now); }
  void tick(Time now);

  void set_estop_closed(bool closed) { estop_closed_ = closed; }
  void set_interlock_closed(bool closed);

  bool laser_on() const;
  bool lamps_on() const;
  // An exposure that began since the last call.
  std::optional<Exposure> take_exposure();

 private:
  Abort may_write(const Object&, std::int64_t) override { return Abort::none; }
  void written(const Object& object, Time now) override;
  void received(Time now) override;
  void synced(Time) override {}
  void connection_lost(std::uint16_t, Time) override {}
  void state_changed(NmtState state, Time now) override;
  void restarted(Time now) override;
  void switch_outputs();

  Node node_;
  Object &inputs_, &outputs_, &error_mode_, &error_value_, &trigger_, &exposure_us_, &outputs_shown_, &last_trigger_, &last_exposure_us_;
  bool estop_closed_ = true;
  bool interlock_closed_ = true;
  std::uint8_t on_ = 0;  // outputs as they are
  std::vector<Exposure> exposures_;
};

}  // namespace lf::devices
