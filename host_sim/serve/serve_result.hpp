// What a served run came to, against the truth: how far the job got in the world, whatever the core believes, and how well real time was held.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/record/result.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/serve/serve_loop.hpp"
#include "host_sim/serve/served_camera.hpp"

namespace lf::serve {

struct ServeResult {
  std::string scenario;
  std::uint64_t seed = 0;
  std::string version;
  record::ProvenanceRecord provenance;
  std::string nodes;  // served
  // Every task of the scenario is done in the world: the valve within 3 degrees of its last target, every button clicked as often as asked for.
  bool success = false;
  std::vector<record::TaskRecord> tasks;
  record::ContactRecord contact;
  std::uint64_t frames_received = 0, frames_sent = 0, send_failures = 0, error_frames = 0;
  double load_percent = record::unknown;  // of the bus at the map's bit rate, by the frames that were seen, their stuff bits included
  record::TimesRecord answer_us;          // from a SYNC's reception to the last answer's way into the kernel
  std::optional<ServedCamera::Stats> camera;
  PaceStats pace;
  double simulated_s = 0;
};

ServeResult make_result(const ServeLoop& loop, const ServedCamera* camera, const mission::MissionConfig& mission, const PanelNames& names);

// JSON text, two blanks of indentation, a newline at the end.
std::string serve_result_json(const ServeResult& result);

}  // namespace lf::serve
