#include "host_sim/judge/verdict.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace lf::judge {

namespace {

constexpr double ms = 1e-3;  // a moment
constexpr std::array<const char*, joint_count> joint_names{"slew", "shoulder", "elbow", "roll", "jaw"};

std::string formatted(const char* format, double a, double b = 0) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

// The end of the last moment that is so; `from_s` when none is after it.
template <class Is>
double last_s(const std::vector<Moment>& moments, double from_s, Is is) {
  for (std::size_t i = moments.size(); i > 0; --i) {
    const double t_s = static_cast<double>(i) * ms;
    if (t_s <= from_s) break;
    if (is(moments[i - 1])) return t_s;
  }
  return from_s;
}

bool moves(const Moment& moment, double standing_rad_s) {
  return std::any_of(moment.speed_rad_s.begin(), moment.speed_rad_s.end(), [&](float speed) { return speed >= standing_rad_s; });
}

std::size_t node_index(const std::string& node) {
  constexpr std::array<const char*, joint_count + 1> names{"slew", "shoulder", "elbow", "roll", "jaw", "io"};
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), node) - names.begin());
}

// A drive that hears nothing of the master any more.
bool cut_off(const Cause& cause) { return cause.rule->kind == "silent" || cause.rule->kind == "bus_off"; }

// Until an order acts: up to a SYNC period until the SYNC, one that is interpolated, and the arm's own compliance.
constexpr std::size_t takes_effect_ms = 20;

struct Deadline {
  double at_s = 0;       // from when on time counts
  double allowed_s = 0;  // until the stop is on the bus
};

Deadline report_of(const Seen& seen, const Cause& cause, double begins_s, const SafetyFigures& figures) {
  const double stop_s = figures.stop_ms * ms, unread_s = figures.unread_ms * ms;
  switch (cause.rule->report) {
    case Report::frame: {
      const std::optional<double> said = cause.rule->kind == "estop" ? seen.chain_open_s : seen.fault_reported_s;
      return {std::max(begins_s, said.value_or(begins_s)), stop_s};
    }
    case Report::second_master: return {seen.second_master_s.value_or(begins_s), stop_s};
    case Report::silence: {
      const std::size_t node = node_index(cause.node);
      const double heard_s = cut_off(cause) && node < seen.last_heard_s.size() ? seen.last_heard_s[node] : begins_s;
      return {std::max(heard_s, begins_s - 0.004), unread_s};
    }
    case Report::unheard: return {begins_s, figures.self_stop_s};
    // The arm halts on its own path first, then each drive goes down through every state.
    case Report::halt: return {begins_s + 0.004, figures.halt_s};
    // Three ticks without a time are a lost clock; an order is read with the next tick.
    case Report::at_once: return {begins_s + (cause.rule->kind == "clock_lost" ? 0.012 : 0.004), stop_s};
    case Report::none: break;
  }
  return {begins_s, stop_s};
}

class Judge {
 public:
  Judge(const Seen& seen, const Situation& situation, const Ending& ending, const SafetyFigures& figures)
      : moments_(seen.moments), seen_(seen), situation_(situation), ending_(ending), figures_(figures) {}

  Verdict verdict() {
    forces();
    if (const Cause* stopping = find_stop(); stopping != nullptr && !situation_.powering_up) stop(*stopping);
    if (situation_.powering_up) nothing_moves();
    the_end();
    the_account();
    return verdict_;
  }

 private:
  void wrong(const std::string& what) { verdict_.wrong.push_back(what); }

  // The cause that has to stop the arm, the first of them.
  const Cause* find_stop() {
    const Cause* first = nullptr;
    for (std::size_t i = 0; i < situation_.causes.size(); ++i) {
      if (situation_.causes[i].rule->demand != Demand::stop) continue;
      if (first != nullptr && situation_.begins_s[i] >= begins_s_) continue;
      first = &situation_.causes[i];
      begins_s_ = situation_.begins_s[i];
    }
    return first;
  }

  std::uint8_t unreachable() const {
    std::uint8_t bits = 0;
    for (const Cause& cause : situation_.causes) {
      const std::size_t joint = node_index(cause.node);
      if (cut_off(cause) && joint < joint_count) bits |= static_cast<std::uint8_t>(1u << joint);
      if (cause.rule->report == Report::unheard || cause.node == "master") bits = 0xFF;
    }
    return bits;
  }

  void forces() {
    for (const Moment& moment : moments_) verdict_.force_n = std::max(verdict_.force_n, double(moment.force_n));
    if (verdict_.force_n > figures_.force_n) wrong(formatted("%.0f N of contact", verdict_.force_n));
  }

  void stop(const Cause& cause) {
    const std::uint8_t reachable = static_cast<std::uint8_t>(~unreachable());
    Deadline report = report_of(seen_, cause, begins_s_, figures_);
    if (cause.node == "master") report.allowed_s = figures_.self_stop_s;
    const double stopped_s = last_s(moments_, report.at_s, [&](const Moment& m) { return (m.told_to_run & reachable) != 0; });
    const double self_s = report.at_s + figures_.self_stop_s;
    const double on_bus_s =
        reachable == 0 ? std::min(self_s, last_s(moments_, report.at_s, [](const Moment& m) { return m.told_to_run != 0; })) : stopped_s;
    verdict_.stop_ms = (on_bus_s - report.at_s) / ms;
    if (on_bus_s - report.at_s > report.allowed_s + ms)
      wrong(formatted("still told to run %.0f ms after the report", (on_bus_s - report.at_s) / ms));
    // A drive that cannot be reached stops when it misses the master.
    const double from_s = std::min(on_bus_s, report.at_s + report.allowed_s);
    stands(from_s);
    loses_power(from_s);
  }

  void stands(double from_s) {
    const std::uint8_t cut = unreachable();
    double standing_s = from_s;
    for (std::size_t joint = 0; joint < joint_count; ++joint) {
      const auto at = static_cast<std::size_t>(from_s / ms);
      // A drive brakes from the SYNC on that follows the order: until then it does what it was told before.
      double speed = 0;
      for (std::size_t i = at; i < std::min(at + takes_effect_ms, moments_.size()); ++i)
        speed = std::max<double>(speed, moments_[i].speed_rad_s[joint]);
      const double late_s = (cut & (1u << joint)) != 0 ? figures_.self_stop_s : 0;
      const double allowed_s = speed / situation_.deceleration_rad_s2[joint] + figures_.settling_s + late_s;
      const double moved_s = last_s(moments_, from_s, [&](const Moment& m) { return m.speed_rad_s[joint] >= figures_.standing_rad_s; });
      standing_s = std::max(standing_s, moved_s);
      if (moved_s - from_s > allowed_s)
        wrong(std::string(joint_names[joint]) + formatted(" moves %.2f s after the stop, %.2f s are allowed", moved_s - from_s, allowed_s));
    }
    verdict_.standing_s = standing_s - from_s;
  }

  void loses_power(double from_s) {
    const double standing_s = from_s + verdict_.standing_s.value_or(0);
    const std::uint8_t reachable = static_cast<std::uint8_t>(~unreachable());
    const double reached_off_s = last_s(moments_, from_s, [&](const Moment& m) { return (m.power & reachable) != 0; });
    const double off_s = last_s(moments_, from_s, [](const Moment& m) { return m.power != 0; });
    verdict_.power_off_s = std::max(0.0, reached_off_s - standing_s);
    verdict_.stop_to_off_s = off_s - from_s;
    if (*verdict_.power_off_s > figures_.off_after_standing_s + ms)
      wrong(formatted("power is off %.2f s after standing", *verdict_.power_off_s));
    if (*verdict_.stop_to_off_s > figures_.off_after_stop_s + ms)
      wrong(formatted("power is off %.2f s after the stop", *verdict_.stop_to_off_s));
  }

  void nothing_moves() {
    const Cause* cause = find_stop();
    if (cause == nullptr || cause->rule->kind == "reboot") return;  // what has rebooted is booted again
    // Without power the joints settle in their gears.
    const double moved_s = last_s(moments_, 0, [&](const Moment& m) { return m.power != 0 && moves(m, figures_.standing_rad_s); });
    if (moved_s > 0) wrong(formatted("the arm moves at %.2f s although powering up had to end", moved_s));
  }

  // However it ended, the arm stands and has no power, unless the core says that it holds the arm.
  void the_end() {
    if (moments_.empty()) return wrong("nothing was seen");
    const bool must_end = ending_.expected_to_end;
    if (!ending_.ended && must_end) wrong("it did not end");
    if (!ending_.ended) return;
    constexpr std::size_t tail = 200;  // ms
    const std::size_t from = moments_.size() > tail ? moments_.size() - tail : 0;
    bool moving = false, powered = false;
    for (std::size_t i = from; i < moments_.size(); ++i) {
      moving = moving || moves(moments_[i], figures_.standing_rad_s);
      powered = powered || moments_[i].power != 0;
    }
    if (moving) wrong("the arm moves after the end");
    if (powered && !ending_.holds) wrong("power is on after the end");
  }

  void the_account() {
    verdict_.false_success = ending_.success && !ending_.contradicted.empty();
    if (verdict_.false_success) wrong("false success: " + ending_.contradicted);
    verdict_.went_on = ending_.success && ending_.contradicted.empty();
    if (situation_.over || situation_.fails_anyway || !ending_.ended) return;
    const bool all_go_on =
        std::all_of(situation_.causes.begin(), situation_.causes.end(), [](const Cause& c) { return c.rule->demand == Demand::go_on; });
    if (all_go_on && !ending_.success) verdict_.unclear.push_back("it should have gone on: " + ending_.reason);
    if (ending_.success || all_go_on) return;
    for (const Cause& cause : situation_.causes) {
      for (const std::string& word : cause.rule->named_by) {
        if (ending_.reason.find(word) != std::string::npos) return;
      }
    }
    verdict_.unclear.push_back("the reason does not name the cause: " + (ending_.reason.empty() ? "none is given" : ending_.reason));
  }

  const std::vector<Moment>& moments_;
  const Seen& seen_;
  const Situation& situation_;
  const Ending& ending_;
  const SafetyFigures& figures_;
  Verdict verdict_;
  double begins_s_ = 0;
};

}  // namespace

Verdict judge(const Seen& seen, const Situation& situation, const Ending& ending, const SafetyFigures& figures) {
  return Judge(seen, situation, ending, figures).verdict();
}

}  // namespace lf::judge
