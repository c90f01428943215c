// The simulator as hardware: world, nodes and camera stepped in real time, a bus answered in between.
//
//   until the next millisecond is due   what comes in is handed to the nodes, and their answers go out at once
//   then                                the world moves a millisecond, drives close their loops, the camera sees
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hal/sim/sim_config.hpp"
#include "host_sim/serve/can_link.hpp"
#include "host_sim/serve/loop_camera.hpp"
#include "host_sim/serve/node_set.hpp"
#include "host_sim/serve/pace.hpp"
#include "host_sim/serve/served_bus.hpp"
#include "host_sim/world/world.hpp"

namespace lf::serve {

class ServeLoop {
 public:
  using Say = std::function<void(const std::string&)>;

  // `camera` may be null: then exposures are taken and nothing is seen. Power comes on at the first turn. `link`, `camera` and `say` outlive the loop.
  // `real_zero_counts` are those of the drives that are not served.
  ServeLoop(const hal::SimConfig& config, const NodeSet& served, CanLink& link, LoopCamera* camera, Say say,
            const PerJoint<std::int32_t>& real_zero_counts = {});

  // One millisecond: returns when it is done.
  void turn();

  Time simulated() const { return pace_.simulated(); }
  const Pace& pace() const { return pace_; }
  ServedBus& bus() { return bus_; }
  const ServedBus& bus() const { return bus_; }
  devices::NodeRack& rack() { return rack_; }
  const world::World& world() const { return world_; }
  LoopCamera* camera() { return camera_; }
  const JointNames& joints() const { return joints_; }

 private:
  void say_link_changes();

  JointNames joints_;
  world::World world_;
  devices::NodeRack rack_;
  CanLink& link_;
  ServedBus bus_;
  LoopCamera* camera_;
  Say say_;
  Pace pace_;
  int said_error_ = 0;
};

}  // namespace lf::serve
