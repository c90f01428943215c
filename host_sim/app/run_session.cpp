#include "host_sim/app/run_session.hpp"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <thread>
#include <utility>

#include "firmware/controller.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/config/event_json.hpp"
#include "hal/core_loop.hpp"
#include "hal/heap_guard/heap_guard.hpp"
#include "hal/sim/sim_platform.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/app/run_experiment.hpp"
#include "host_sim/app/run_recorder.hpp"
#include "host_sim/app/run_result.hpp"
#include "host_sim/judge/truth.hpp"
#include "host_sim/record/folder_in_writing.hpp"
#include "host_sim/scenario/instance.hpp"
#include "shared/version/version.hpp"

namespace lf::app {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double standing_rad_s = 0.02;
constexpr double longest_to_stand_s = 3;  // every stop is over by then

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
        sim_(truth(request, sample_, nominal_)),
        recorder_(folder, nominal_.error_texts, request.say, sim_.optics, nominal_.controller.arm, request.scenario.survey.names),
        platform_(std::make_unique<hal::SimPlatform>(sim_, recorder_.observer())),
        controller_(std::make_unique<Controller>(nominal_.controller)),
        pipeline_(std::make_unique<ScanPipeline>(nominal_.scan)),
        rings_(std::make_unique<hal::CoreRings>()),
        ticks_(static_cast<std::size_t>(request.scenario.time_limit_s / can_map::sync_period.s()) + 1),
        frames_(16384) {
    if (request.record_images)
      recorder_.keep_raw_images(nominal_.controller.arm, nominal_.error_texts.names(), nominal_.controller.camera,
                                nominal_.controller.laser, sim_.optics);
    recorder_.events().say({{"t_s", 0.0},
                            {"kind", "begin"},
                            {"config", request.scenario.file},
                            {"seed", request.seed},
                            {"version", version()},
                            {"date_utc", request.provenance.date_utc},
                            {"command", request.provenance.command}});
  }

  // Runs until the arm stands without power after the mission's end, or to the time limit or an interrupt.
  void run() {
    const std::uint64_t heap_calls = hal::HeapGuard::calls();
    const Clock::time_point start = Clock::now();
    Time now;
    TickOutput out;
    const bool taken = controller_->on_command(Command::start, now);
    recorder_.events().say(
        {{"t_s", config::json_seconds(now)}, {"kind", "order"}, {"order", {{"do", "start"}}}, {"by", "run"}, {"answer", {{"ok", taken}}}});
    while (!settled(now) && now.s() < request_.scenario.time_limit_s && !interrupted()) {
      (void)hal::control_turn(*platform_, *controller_, *rings_, out, now, ticks_);
      recorder_.after_control(controller_->mission());
      if (platform_->vision_runs()) {
        hal::vision_turn(*platform_, *pipeline_, *rings_, frames_,
                         [&](Port port, hal::PortStatus status) { controller_->on_port_error(port, status, now); });
        recorder_.after_vision(*pipeline_);
      }
      if (request_.realtime) std::this_thread::sleep_until(start + std::chrono::nanoseconds(now.ns()));
    }
    wall_s_ = std::chrono::duration<double>(Clock::now() - start).count();
    heap_calls_ = hal::HeapGuard::calls() - heap_calls;
  }

  // The arm stands and has no power. A mission that ends with the arm held under power never gets there, nor does one that is not safe.
  bool settled(Time now) {
    if (!controller_->mission().outcome().ended) return false;
    if (ended_s_ < 0) ended_s_ = now.s();
    return safe() || now.s() >= ended_s_ + longest_to_stand_s;
  }

  bool safe() const {
    const JointReadings joints = platform_->world().readings();
    for (std::size_t i = 0; i < nominal_.controller.arm.joint_count(); ++i) {
      if (platform_->devices().power(i) != devices::DrivePower::off || std::abs(joints[i].velocity_rad_s) >= standing_rad_s) return false;
    }
    return true;
  }

  // A scenario that expects a failure has succeeded when the mission failed so, and safely. The fault itself is compared: its text may quote another one's name.
  static void hold_against(const std::string& expected, const mission::Outcome& outcome, bool safe, record::RunResult& result) {
    if (!result.failure) {
      result.failure = record::FailureRecord{"end", "expected was the failure '" + expected + "', but the mission succeeded"};
    } else if (!outcome.ended || outcome.success || expected != safety::name(outcome.fault)) {
      result.failure->reason += "; expected was '" + expected + "'";
    } else if (!safe) {
      result.failure->reason += ", as expected, but the arm moves or has power 3 s after the end";
    } else {
      result.expected_failure = std::exchange(result.failure, std::nullopt);
    }
  }

  void judge(record::RunResult& result) {
    result.failure = failure_of(*controller_, nominal_.error_texts, platform_->world(), recorder_, request_.scenario, interrupted());
    if (!result.failure) result.failure = disagreement(*controller_, platform_->world(), recorder_, request_.scenario.survey.names);
    const bool held = controller_->mission().step() == mission::Step::held;
    if (!result.failure && !safe() && !held) result.failure = record::FailureRecord{"end", "the end is not safe"};
    // Before what was expected of it: a mission that did its tasks where it should have failed has claimed nothing that is not so.
    result.false_success = result.failure.has_value() && controller_->mission().outcome().ended && controller_->mission().outcome().success;
    const std::string& expected = request_.scenario.expect.failure;
    if (expected != scenario::Expect::nothing && !interrupted()) {
      hold_against(expected, controller_->mission().outcome(), safe(), result);
    } else if (result.failure && !safe() && !held && !interrupted() && controller_->mission().outcome().ended) {
      result.failure->reason += "; the arm moves or has power 3 s after the end";
    }
    result.success = !result.failure.has_value();
  }

  record::RunResult result() {
    record::RunResult result;
    result.scenario = request_.scenario.name;
    result.seed = request_.seed;
    result.version = version();
    result.provenance = request_.provenance;
    result.provenance.scenario_file = request_.scenario.file;
    if (!request_.experiment.empty()) result.provenance.experiment = record::hash_of(request_.experiment);
    result.drawn = drawn(sample_, request_.scenario.joints.size());
    judge(result);
    result.faults = recorder_.events().faults();
    result.faults_left_out = recorder_.events().faults_left_out();
    tell_end(result);
    recorder_.finish(platform_->world(), result.failure ? result.failure->reason : "");
    result.phases = recorder_.phases().phases();
    result.faults_not_made = faults_not_made(request_.scenario, *platform_);
    result.tasks = task_records(*controller_, platform_->world(), recorder_, request_.scenario.survey.names);
    result.errors = score(recorder_, sim_);
    result.calibration = calibration_of(recorder_.calibration(), controller_->mission().tasks());
    const world::ContactReport contacts = platform_->world().contacts();
    result.contact = {contacts.peak_force_n, contacts.unintended.size()};
    if (hal::HeapGuard::available()) result.core.heap_calls = heap_calls_;
    result.core.controller_bytes = sizeof(Controller);
    result.core.tick_us = record::times_record(ticks_.times_us());
    result.core.frame_us = record::times_record(frames_.times_us());
    result.core.rejected_inputs = rejected_inputs(*controller_, *pipeline_, *rings_);
    const devices::BusStats bus = platform_->devices().bus();
    result.bus = {bus.load_percent, bus.load_unstuffed_percent, bus.load_worst_case_percent, bus.frames, bus.errors};
    result.host = {build_type(), request_.render_threads, std::string(compiler()) + ", " + revision()};
    const double simulated_s = platform_->now().s();
    result.time = {simulated_s, wall_s_, wall_s_ > 0 ? simulated_s / wall_s_ : record::unknown};
    result.digest = recorder_.digest();
    return result;
  }

  record::ReportData report(const record::RunResult& result) {
    record::ReportData data;
    data.result = result;
    data.command = request_.provenance.command;
    data.conditions = conditions(sample_);
    data.errors = record::report_errors(result, sample_.attenuation_per_m);
    if (request_.outside) recorder_.pictures().draw_outside(sim_.optics, request_.render_threads);
    data.pictures = std::move(recorder_.pictures().pictures());
    if (const std::optional<Located>& located = recorder_.panel().located()) {
      data.cloud = located->cloud;
      data.fit = located->panel.fit;
    }
    data.charts = recorder_.charts(nominal_.controller.mission_limits);
    data.charts.push_back(tick_chart());
    data.motion = recorder_.motion().motion(sim_.world);
    if (!recorder_.write_error().empty()) data.notes.push_back("Not everything could be recorded: " + recorder_.write_error() + ".");
    if (result.calibration && !result.calibration->doubt.empty())
      data.notes.push_back("Doubtful calibration: " + result.calibration->doubt + ". " + result.calibration->remedy);
    for (const world::UnintendedContact& contact : platform_->world().contacts().unintended)
      data.notes.push_back("Unintended contact: " + judge::contact_text(contact) + ".");
    return data;
  }

  const std::string& write_error() const { return recorder_.write_error(); }

 private:
  // The core has one tick a telemetry: each sample is the longest of those until the next.
  record::ReportChart tick_chart() const {
    const std::vector<double>& t_s = recorder_.curves().times_s();
    const std::vector<double>& tick_us = ticks_.times_us();
    std::vector<double> longest_us;
    for (std::size_t i = 0; i < t_s.size(); ++i) {
      const auto first = tick_us.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(i * ticks_a_sample, tick_us.size()));
      const auto last = tick_us.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>((i + 1) * ticks_a_sample, tick_us.size()));
      longest_us.push_back(first == last ? record::unknown : *std::max_element(first, last));
    }
    return {"Core's tick, the longest of ten, CPU time on this host", "µs", {{"tick", t_s, longest_us, false}}};
  }

  void tell_end(const record::RunResult& result) {
    nlohmann::ordered_json line{{"t_s", config::json_seconds(platform_->now())}, {"kind", "end"}, {"success", result.success}};
    if (result.failure) line["failure"] = {{"phase", result.failure->phase}, {"text", result.failure->reason}};
    if (result.expected_failure)
      line["expected_failure"] = {{"phase", result.expected_failure->phase}, {"text", result.expected_failure->reason}};
    recorder_.events().say_end(line);
  }

  static hal::SimConfig truth(const RunRequest& request, const scenario::Sample& sample, const scenario::Nominal& nominal) {
    hal::SimConfig sim = scenario::make_truth(request.scenario, sample, nominal, request.render_threads);
    sim.given_sight = request.given_sight;
    return sim;
  }

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
  double ended_s_ = -1;
  std::uint64_t heap_calls_ = 0;
};

}  // namespace

RunOutcome run_mission(const RunRequest& request) {
  std::optional<record::FolderInWriting> writing;
  if (!request.out.empty()) {
    writing.emplace(request.out, request.experiment);
    keep_scenario(request.scenario, writing->folder());
  }
  Session session(request, writing ? &writing->folder() : nullptr);
  session.run();
  RunOutcome outcome;
  outcome.result = session.result();
  outcome.interrupted = interrupted();
  outcome.write_error = session.write_error();
  if (!writing) return outcome;
  try {
    if (outcome.write_error.empty()) {
      writing->folder().write("result.json", record::result_json(outcome.result));
      writing->folder().write("report.html", record::report_html(session.report(outcome.result)));
      outcome.has_report = true;
    }
    const bool whole = outcome.write_error.empty() && !outcome.interrupted;
    outcome.kept = whole || !writing->place_is_taken();
    if (outcome.kept) writing->publish();
  } catch (const record::RecordError& error) {
    outcome.write_error = error.what();
    outcome.kept = !writing->place_is_taken();
    if (outcome.kept) writing->publish();
  }
  if (!outcome.write_error.empty()) {
    outcome.has_report = false;
    outcome.result.success = false;
    outcome.result.failure = record::FailureRecord{"record", outcome.write_error};
  }
  return outcome;
}

}  // namespace lf::app
