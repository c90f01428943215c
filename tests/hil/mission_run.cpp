#include "tests/hil/mission_run.hpp"

#include <sstream>

#include "hal/heap_guard/heap_guard.hpp"
#include "hal/lockstep.hpp"

namespace lf::test {

namespace {

class Recorder : public hal::SimObserver {
 public:
  void on_bus_frame(const devices::BusRecord& record) override {
    add(&record.frame.id, sizeof record.frame.id);
    add(record.frame.data.data(), record.frame.data.size());
    const std::int64_t t = record.delivered.ns();
    add(&t, sizeof t);
  }
  void on_telemetry(const Telemetry& telemetry) override {
    for (const Event& event : telemetry.events) events.push_back(event);
  }

  void add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) digest = (digest ^ bytes[i]) * 0x100000001b3u;
  }

  std::vector<Event> events;
  std::uint64_t digest = 0xcbf29ce484222325u;
};

}  // namespace

MissionRun run_mission(const std::string& scenario_name, std::uint64_t seed, const std::vector<std::string>& overrides, int render_threads,
                       const Meddle& meddle) {
  const scenario::Scenario scenario = scenario::load_scenario(scenario_name, overrides);
  const scenario::Sample sample = scenario::draw(scenario, seed);
  const scenario::Nominal nominal = scenario::make_nominal(scenario, sample.lamps_lit);
  Recorder recorder;
  hal::SimPlatform platform(scenario::make_truth(scenario, sample, nominal, render_threads), recorder);
  hal::Lockstep<hal::SimPlatform> lockstep(platform, nominal.controller, nominal.scan);

  const std::uint64_t heap_before = hal::HeapGuard::calls();
  lockstep.controller().on_command(Command::start, Time{});
  while (!lockstep.ended() && lockstep.now().s() < scenario.time_limit_s) {
    lockstep.step();
    if (meddle) meddle(lockstep.now(), lockstep.controller(), platform);
  }
  // What was decided last has to reach the devices.
  for (int i = 0; i < 25; ++i) lockstep.step();

  MissionRun run;
  const mission::Mission& mission = lockstep.controller().mission();
  run.outcome = mission.outcome();
  run.events = recorder.events;
  run.tasks.assign(mission.tasks().begin(), mission.tasks().end());
  run.simulated_s = lockstep.now().s();
  run.valve_rad = platform.world().valve_angle_rad(0);
  for (std::size_t i = 0; i < run.presses.size(); ++i) run.presses[i] = platform.world().button(i).presses;
  run.contacts = platform.world().contacts();
  run.heap_calls = hal::HeapGuard::calls() - heap_before;
  const std::uint64_t state = platform.world().state_digest();
  recorder.add(&state, sizeof state);
  run.digest = recorder.digest;
  run.refused_frames = lockstep.controller().rejected_inputs() + lockstep.controller().network().stats().refused_total();
  run.laser_on_at_end = platform.devices().laser_on();
  run.lamps_on_at_end = platform.devices().lamps_on();
  return run;
}

std::string describe(const MissionRun& run) {
  std::ostringstream out;
  out << (run.outcome.success ? "success" : "failure") << " after " << run.simulated_s << " s, valve at " << deg_from_rad(run.valve_rad)
      << " deg, presses";
  for (const std::uint32_t presses : run.presses) out << ' ' << presses;
  if (!run.outcome.success) {
    out << "; in " << run.outcome.stage << " (" << mission::row(run.outcome.step).name << "): " << safety::name(run.outcome.fault)
        << ", code " << run.outcome.code;
  }
  for (const Event& event : run.events) {
    out << "\n  " << event.t.s() << " s ";
    switch (event.kind) {
      case Event::Kind::step: out << "step " << mission::row(event.step).name; break;
      case Event::Kind::fault:
        out << "fault " << safety::name(event.fault) << " in " << mission::row(event.step).name << ", code " << event.code << " -> "
            << safety::name(event.reaction);
        break;
      case Event::Kind::located: out << "located, handle at " << deg_from_rad(event.value) << " deg"; break;
      case Event::Kind::emcy: out << "EMCY " << event.emcy << " of node " << event.code; break;
      case Event::Kind::task_done: out << "task " << int{event.task} << " done: " << event.value; break;
      case Event::Kind::task_failed: out << "task " << int{event.task} << " failed: " << event.value; break;
    }
  }
  return out.str();
}

}  // namespace lf::test
