// Flies a mission against the simulated world, sight given, and records what the controller was told, saw and answered: record_mission FILE
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>

#include "hal/core_loop.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/scenario/instance.hpp"
#include "tests/hil/known_sight.hpp"
#include "tests/target/record.hpp"

namespace lf::test {
namespace {

static_assert(std::endian::native == std::endian::little);

class Writer : public RecordStream {
 public:
  explicit Writer(const char* path) : file_(path, std::ios::binary) {}
  void bytes(const void* data, std::size_t size) { file_.write(static_cast<const char*>(data), static_cast<std::streamsize>(size)); }
  void broken() { std::abort(); }
  bool close() {
    file_.close();
    return file_.good();
  }

 private:
  std::ofstream file_;
};

// A platform that notes what passes.
class Recording : public hal::Unattended {
 public:
  explicit Recording(KnownSight& inner) : inner_(inner) {}
  RecordedTick tick;

  hal::PortStatus wait_for_tick(Time& t) {
    const hal::PortStatus status = inner_.wait_for_tick(t);
    tick.t = t;
    return status;
  }
  hal::PortStatus receive_can(std::uint8_t bus, hal::ReceivedFrame& received) {
    const hal::PortStatus status = inner_.receive_can(bus, received);
    if (status == hal::port_ok && !tick.received.push_back({received.frame, received.t})) std::abort();
    return status;
  }
  hal::PortStatus send_can(std::uint8_t bus, std::span<const CanFrame> frames) {
    for (const CanFrame& frame : frames)
      if (!tick.sent.push_back(frame)) std::abort();
    return inner_.send_can(bus, frames);
  }
  hal::PortStatus receive_image(std::uint8_t camera, Image& image) { return inner_.receive_image(camera, image); }
  hal::PortStatus submit_panel(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) {
    return inner_.submit_panel(request, still, cloud);
  }
  hal::PortStatus receive_panel(PanelResult& result) {
    const hal::PortStatus status = inner_.receive_panel(result);
    if (status == hal::port_ok && !tick.panel.push_back(result)) std::abort();
    return status;
  }
  hal::PortStatus publish(const Telemetry& telemetry) {
    tick.step = telemetry.step;
    tick.events = static_cast<std::uint32_t>(telemetry.events.size());
    return inner_.publish(telemetry);
  }

 private:
  KnownSight& inner_;
};
static_assert(hal::Platform<Recording>);

int record(const char* path) {
  const scenario::Scenario scenario = scenario::load_scenario("default", {});
  const scenario::Sample sample = scenario::draw(scenario, 1);
  scenario::Nominal nominal = scenario::make_nominal(scenario, sample.lamps_lit);
  hal::SimConfig truth = scenario::make_truth(scenario, sample, nominal, 1);
  // Nobody looks at the pictures.
  for (optics::CameraConfig& camera : truth.optics.cameras) {
    camera.intrinsics.width = 16;
    camera.intrinsics.height = 12;
  }
  hal::SimObserver observer;
  const auto world = std::make_unique<hal::SimPlatform>(truth, observer);
  KnownSight sight(*world, nominal.controller, scenario::true_base_from_panel(scenario.panel, sample));
  Recording platform(sight);
  const auto controller = std::make_unique<Controller>(nominal.controller);
  const auto pipeline = std::make_unique<ScanPipeline>(nominal.scan);
  const auto rings = std::make_unique<hal::CoreRings>();

  Writer writer(path);
  std::uint32_t magic = record_magic;
  pass_all(writer, magic, nominal.controller);
  TickOutput out;
  Time now;
  hal::NoProbe probe;
  controller->on_command(Command::start, now);
  bool ended = false;
  while (!ended && now.s() < scenario.time_limit_s) {
    // What vision left since the last tick is looked at, and put back.
    for (ScanStats stats; rings->scan_stats.pop(stats);)
      if (!platform.tick.stats.push_back(stats)) std::abort();
    for (const ScanStats& stats : platform.tick.stats) rings->scan_stats.push(stats);
    (void)hal::control_turn(platform, *controller, *rings, out, now, probe);
    for (const ScanCommand& order : out.scan)
      if (!platform.tick.orders.push_back(order)) std::abort();
    hal::vision_turn(platform, *pipeline, *rings, probe, [](Port, hal::PortStatus) { std::abort(); });
    ended = controller->mission().outcome().ended;
    platform.tick.last = ended ? 1 : 0;
    pass(writer, platform.tick);
    platform.tick = {};
  }
  if (!controller->mission().outcome().success) {
    std::fprintf(stderr, "the mission failed: nothing worth a record\n");
    return 1;
  }
  if (writer.close()) return 0;
  std::fprintf(stderr, "%s: cannot be written\n", path);
  return 2;
}

}  // namespace
}  // namespace lf::test

int main(int argc, char** argv) {
  if (argc == 2) return lf::test::record(argv[1]);
  std::fprintf(stderr, "usage: %s FILE\n", argv[0]);
  return 2;
}
