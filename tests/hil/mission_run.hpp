// A mission from scenario to end in one call, for tests: what the core decided, and what was true.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "firmware/mission/mission.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/scenario/instance.hpp"

namespace lf::test {

struct MissionRun {
  mission::Outcome outcome;
  std::vector<Event> events;
  std::vector<mission::TaskResult> tasks;
  double simulated_s = 0;
  double valve_rad = 0;                    // true, at the end
  std::array<std::uint32_t, 3> presses{};  // true
  world::ContactReport contacts;
  std::uint64_t heap_calls = 0;  // inside the core
  std::uint64_t digest = 0;      // FNV-1a over every CAN frame with its time, and the world's state at the end
  std::uint32_t refused_frames = 0;
  bool laser_on_at_end = false, lamps_on_at_end = false;
};

// What a test wants to do while the mission runs; called after every control period.
using Meddle = std::function<void(Time now, Controller& controller, hal::SimPlatform& platform)>;

MissionRun run_mission(const std::string& scenario, std::uint64_t seed, const std::vector<std::string>& overrides = {},
                       int render_threads = 1, const Meddle& meddle = {});

// How it ended, and the events on the way, a line each.
std::string describe(const MissionRun& run);

}  // namespace lf::test
