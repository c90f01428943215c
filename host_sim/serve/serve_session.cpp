#include "host_sim/serve/serve_session.hpp"

#include <memory>
#include <optional>

#include "host_sim/record/candump_log.hpp"
#include "host_sim/record/run_folder.hpp"
#include "host_sim/serve/come_first.hpp"
#include "host_sim/serve/render_rings.hpp"
#include "host_sim/serve/serve_orders.hpp"
#include "host_sim/serve/socket_can_link.hpp"
#include "shared/input_error.hpp"

namespace lf::serve {

namespace {

constexpr std::uint64_t steps_between_orders = 10;

std::unique_ptr<FrameRenderer> make_renderer(const ServeRequest& request, const optics::OpticsConfig& optics) {
  if (request.renderer.empty()) return std::make_unique<ThreadRenderer>(optics);
  return std::make_unique<RemoteRenderer>(request.renderer);
}

// Faults that a scenario may ask for, but that cannot be made here: on a real bus, or without seeing where the core's mission stands.
void say_what_cannot_be(const hal::SimConfig& sim, const ServeLoop::Say& say) {
  bool bus = false;
  for (const devices::DeviceFault& fault : sim.devices.faults) {
    const bool master = fault.kind == devices::DeviceFaultKind::bus_off && fault.node == can_map::master_node;
    bus = bus || master || fault.kind == devices::DeviceFaultKind::error_frames || devices::of_a_second_master(fault.kind);
  }
  if (bus) say("the scenario's error frames, second master and bus-off of the master cannot be made on a real bus; they are left out");
  if (!sim.faults.empty())
    say("the scenario's faults of ports, sight, world and orders, and those at a step, happen in `run` only; they are left out");
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
  if (request.scenario.joints.size() != JointNames().size() && !request.nodes.is_all())
    throw InputError("--nodes: of an arm that has not five drives all nodes are served, or none is simulated: leave it out");
  for (std::size_t i = 0; i < request.scenario.told_arm.joint_count(); ++i) {
    if (!request.nodes.has(i)) scenario::check_overheard(request.scenario.drives, request.scenario.joints, i);
  }
  const scenario::Sample sample = scenario::draw(request.scenario, request.seed);
  const scenario::Nominal nominal = scenario::make_nominal(request.scenario, sample.lamps_lit);
  hal::SimConfig sim = scenario::make_truth(request.scenario, sample, nominal, request.render_threads);
  for (std::size_t i = 0; i < sim.devices.drives.size(); ++i) sim.devices.drives[i].encoder_zero_counts = request.zero_counts[i];
  say_what_cannot_be(sim, say);
  std::optional<record::CandumpLog> log;
  if (request.folder != nullptr) log.emplace(request.folder->file("can0.log"), request.can);

  const CameraIntrinsics& size = nominal.controller.camera.intrinsics;
  const std::unique_ptr<FrameTarget> target = open_frame_target(request.camera, size.width, size.height);
  std::unique_ptr<FrameRenderer> renderer;
  std::optional<ServedCamera> camera;
  if (target) {
    renderer = make_renderer(request, sim.optics);
    camera.emplace(*renderer, *target, sim);
  }
  warm_up(sim.world);
  OrderReader orders(request.orders);
  SocketCanLink link(request.can);
  come_first();
  ServeLoop loop(sim, request.nodes, link, camera ? &*camera : nullptr, say, request.zero_counts);
  if (log) loop.bus().set_tap([&log](Time t, const CanFrame& frame) { log->write(t, frame); });
  say("serving nodes " + request.nodes.text() + " on " + request.can + ", camera " + request.camera);

  for (std::uint64_t step = 0; !stop() && (request.for_s <= 0 || loop.simulated().s() < request.for_s); ++step) {
    loop.turn();
    if (step % steps_between_orders == 0) orders.carry_out(loop, say);
  }

  ServeResult result = make_result(loop, camera ? &*camera : nullptr, nominal.controller.mission, request.scenario.survey.names);
  result.scenario = request.scenario.name;
  result.seed = request.seed;
  result.nodes = request.nodes.text();
  result.send_failures = link.stats().expired + link.stats().refused;
  if (log && !log->close()) say(log->sink().error());
  return result;
}

}  // namespace lf::serve
