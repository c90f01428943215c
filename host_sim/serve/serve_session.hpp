// `lanternfish serve` from its options to its result.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "host_sim/record/run_folder.hpp"
#include "host_sim/scenario/scenario.hpp"
#include "host_sim/serve/node_set.hpp"
#include "host_sim/serve/serve_result.hpp"
#include "shared/messages/joint_io.hpp"

namespace lf::serve {

struct ServeRequest {
  scenario::Scenario scenario;
  std::uint64_t seed = 1;
  std::string can;  // SocketCAN interface
  NodeSet nodes = NodeSet::all();
  PerJoint<std::int32_t> zero_counts{};  // where the drives count from: the served ones, and the real ones that are followed
  std::string camera = "none";           // see open_frame_target()
  std::string renderer;                  // file of a renderer elsewhere (render_rings.hpp); empty: a thread here
  int render_threads = 1;
  std::string orders;                           // FIFO of orders (serve_orders.hpp); empty: none
  const record::RunFolder* folder = nullptr;    // gets can0.log; null keeps nothing
  double for_s = 0;                             // 0: until it is told to stop
  std::function<void(const std::string&)> say;  // what happens on the way
};

// Serves until `stop` says so. Throws InputError for what cannot be served, std::runtime_error when this machine's CAN cannot be used.
ServeResult serve(const ServeRequest& request, bool (*stop)());

}  // namespace lf::serve
