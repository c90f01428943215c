#include "host_sim/app/run_session.hpp"

#include <time.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <thread>

#include "firmware/controller.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/core_loop.hpp"
#include "hal/heap_guard/heap_guard.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/app/run_recorder.hpp"
#include "host_sim/app/run_result.hpp"
#include "host_sim/scenario/instance.hpp"
#include "shared/version/version.hpp"

namespace lf::app {

namespace {

using Clock = std::chrono::steady_clock;

// Thread CPU time of each turn of the core.
class CpuProbe {
 public:
  explicit CpuProbe(std::size_t expected) { times_us_.reserve(expected); }
  void begin() { start_ns_ = now_ns(); }
  void end() { times_us_.push_back(1e-3 * static_cast<double>(now_ns() - start_ns_)); }
  const std::vector<double>& times_us() const { return times_us_; }

 private:
  static std::int64_t now_ns() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return std::int64_t{1'000'000'000} * t.tv_sec + t.tv_nsec;
  }
  std::int64_t start_ns_ = 0;
  std::vector<double> times_us_;
};

class Session {
 public:
  Session(const RunRequest& request, const record::RunFolder* folder)
      : request_(request),
        sample_(scenario::draw(request.scenario, request.seed)),
        nominal_(scenario::make_nominal(request.scenario, sample_.lamps_lit)),
        sim_(scenario::make_truth(request.scenario, sample_, nominal_, request.render_threads)),
        recorder_(folder, sim_.world.scene, request.say),
        platform_(std::make_unique<hal::SimPlatform>(sim_, recorder_)),
        controller_(std::make_unique<Controller>(nominal_.controller)),
        pipeline_(std::make_unique<ScanPipeline>(nominal_.scan)),
        rings_(std::make_unique<hal::CoreRings>()),
        ticks_(static_cast<std::size_t>(request.scenario.time_limit_s / can_map::sync_period.s()) + 1),
        frames_(16384) {}

  // Runs to the mission's end, the time limit or an interrupt.
  void run() {
    const std::uint64_t heap_calls = hal::HeapGuard::calls();
    const Clock::time_point start = Clock::now();
    Time now;
    TickOutput out;
    controller_->on_command(Command::start, now);
    while (!controller_->mission().outcome().ended && now.s() < request_.scenario.time_limit_s && !interrupted()) {
      hal::control_turn(*platform_, *controller_, *rings_, out, now, ticks_);
      recorder_.after_control(controller_->mission());
      hal::vision_turn(*platform_, *pipeline_, *rings_, frames_,
                       [&](Port port, hal::PortStatus status) { controller_->on_port_error(port, status, now); });
      recorder_.after_vision(*pipeline_);
      if (request_.realtime) std::this_thread::sleep_until(start + std::chrono::nanoseconds(now.ns()));
    }
    wall_s_ = std::chrono::duration<double>(Clock::now() - start).count();
    heap_calls_ = hal::HeapGuard::calls() - heap_calls;
  }

  record::RunResult result() {
    record::RunResult result;
    result.scenario = request_.scenario.name;
    result.seed = request_.seed;
    result.version = version();
    result.drawn = drawn(sample_);
    result.failure = failure_of(*controller_, platform_->world(), recorder_, request_.scenario, interrupted());
    recorder_.finish(platform_->world(), result.failure ? result.failure->reason : "");
    result.phases = recorder_.phases();
    result.tasks = task_records(*controller_, platform_->world(), recorder_);
    result.errors = score(recorder_, sim_);
    if (!result.failure) result.failure = disagreement(result.tasks);
    result.success = !result.failure.has_value();
    const world::ContactReport contacts = platform_->world().contacts();
    result.contact = {contacts.peak_force_n, contacts.unintended.size()};
    if (hal::HeapGuard::available()) result.core.heap_calls = heap_calls_;
    result.core.controller_bytes = sizeof(Controller);
    result.core.tick_us = record::times_record(ticks_.times_us());
    result.core.frame_us = record::times_record(frames_.times_us());
    result.core.rejected_inputs = rejected_inputs(*controller_, *pipeline_, *rings_);
    const devices::BusStats bus = platform_->devices().bus();
    result.bus = {bus.load_percent, bus.frames, bus.errors};
    result.host = {build_type(), request_.render_threads, std::string(compiler()) + ", " + revision()};
    const double simulated_s = platform_->now().s();
    result.time = {simulated_s, wall_s_, wall_s_ > 0 ? simulated_s / wall_s_ : record::unknown};
    result.digest = recorder_.digest();
    return result;
  }

  record::ReportData report(const record::RunResult& result) {
    record::ReportData data;
    data.result = result;
    data.command = request_.command;
    data.conditions = conditions(sample_);
    data.errors = record::report_errors(result, sample_.attenuation_per_m);
    if (request_.outside) recorder_.draw_outside(sim_.optics, request_.render_threads);
    data.pictures = std::move(recorder_.pictures());
    if (recorder_.located()) {
      data.cloud = recorder_.located()->cloud;
      data.fit = recorder_.located()->panel.fit;
    }
    data.charts = recorder_.charts();
    if (!recorder_.write_error().empty()) data.notes.push_back("Not everything could be recorded: " + recorder_.write_error() + ".");
    for (const world::UnintendedContact& contact : platform_->world().contacts().unintended) data.notes.push_back(contact_note(contact));
    return data;
  }

  const std::string& write_error() const { return recorder_.write_error(); }

 private:
  const RunRequest& request_;
  scenario::Sample sample_;
  scenario::Nominal nominal_;
  hal::SimConfig sim_;
  RunRecorder recorder_;
  std::unique_ptr<hal::SimPlatform> platform_;
  std::unique_ptr<Controller> controller_;
  std::unique_ptr<ScanPipeline> pipeline_;
  std::unique_ptr<hal::CoreRings> rings_;
  CpuProbe ticks_, frames_;
  double wall_s_ = 0;
  std::uint64_t heap_calls_ = 0;
};

}  // namespace

RunOutcome run_mission(const RunRequest& request) {
  std::optional<record::RunFolder> folder;
  if (!request.out.empty()) folder.emplace(request.out);
  Session session(request, folder ? &*folder : nullptr);
  session.run();
  RunOutcome outcome;
  outcome.result = session.result();
  outcome.interrupted = interrupted();
  outcome.write_error = session.write_error();
  if (!folder) return outcome;
  try {
    folder->write("result.json", record::result_json(outcome.result));
    folder->write("report.html", record::report_html(session.report(outcome.result)));
  } catch (const record::RecordError& error) {
    outcome.write_error = error.what();
  }
  return outcome;
}

}  // namespace lf::app
