#include "host_sim/serve/serve_session.hpp"

#include <memory>
#include <optional>

#include "host_sim/record/candump_log.hpp"
#include "host_sim/record/run_folder.hpp"
#include "host_sim/serve/come_first.hpp"
#include "host_sim/serve/render_rings.hpp"
#include "host_sim/serve/serve_orders.hpp"
#include "host_sim/serve/socket_can_link.hpp"

namespace lf::serve {

namespace {

constexpr std::uint64_t steps_between_orders = 10;

std::unique_ptr<FrameRenderer> make_renderer(const ServeRequest& request, const optics::OpticsConfig& optics) {
  if (request.renderer.empty()) return std::make_unique<ThreadRenderer>(optics);
  return std::make_unique<RemoteRenderer>(request.renderer);
}

// Faults that a scenario may ask for and a real bus does not let us make.
void say_what_cannot_be(const devices::DevicesConfig& devices, const ServeLoop::Say& say) {
  for (const devices::DeviceFault& fault : devices.faults) {
    const bool master = fault.kind == devices::DeviceFaultKind::bus_off && fault.node == can_map::master_node;
    if (fault.kind == devices::DeviceFaultKind::error_frames || master) {
      say("the scenario's error frames and bus-off of the master cannot be made on a real bus; they are left out");
      return;
    }
  }
}

// The first steps read the program's pages in, which takes milliseconds: a world that nobody sees pays for it.
void warm_up(const world::WorldConfig& config) {
  world::World world(config);
  for (int i = 0; i < 50; ++i) {
    world.set_drives({});
    world.step();
  }
}

}  // namespace

ServeResult serve(const ServeRequest& request, bool (*stop)()) {
  const ServeLoop::Say say = request.say ? request.say : [](const std::string&) {};
  const scenario::Sample sample = scenario::draw(request.scenario, request.seed);
  const scenario::Nominal nominal = scenario::make_nominal(request.scenario, sample.lamps_lit);
  const hal::SimConfig sim = scenario::make_truth(request.scenario, sample, nominal, request.render_threads);
  say_what_cannot_be(sim.devices, say);
  std::optional<record::RunFolder> folder;
  std::optional<record::CandumpLog> log;
  if (!request.out.empty()) {
    folder.emplace(request.out);
    log.emplace(folder->file("can0.log"), request.can);
  }

  const CameraIntrinsics& size = nominal.controller.camera.intrinsics;
  const std::unique_ptr<FrameTarget> target = open_frame_target(request.camera, size.width, size.height);
  std::unique_ptr<FrameRenderer> renderer;
  std::optional<ServedCamera> camera;
  if (target) {
    renderer = make_renderer(request, sim.optics);
    camera.emplace(*renderer, *target, sim.image_latency);
  }
  warm_up(sim.world);
  OrderReader orders(request.orders);
  SocketCanLink link(request.can);
  come_first();
  ServeLoop loop(sim, request.nodes, link, camera ? &*camera : nullptr, say, request.real_zero_counts);
  if (log) loop.bus().set_tap([&log](Time t, const CanFrame& frame) { log->write(t, frame); });
  say("serving nodes " + request.nodes.text() + " on " + request.can + ", camera " + request.camera);

  for (std::uint64_t step = 0; !stop() && (request.for_s <= 0 || loop.simulated().s() < request.for_s); ++step) {
    loop.turn();
    if (step % steps_between_orders == 0) orders.carry_out(loop, say);
  }

  ServeResult result = make_result(loop, camera ? &*camera : nullptr, nominal.controller.mission);
  result.scenario = request.scenario.name;
  result.seed = request.seed;
  result.nodes = request.nodes.text();
  result.send_failures = link.stats().expired + link.stats().refused;
  if (log && !log->close()) say(log->sink().error());
  return result;
}

}  // namespace lf::serve
