#include "host_sim/judge/verdict.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "host_sim/judge/joint_motions.hpp"
#include "host_sim/judge/report_deadline.hpp"

namespace lf::judge {

namespace {

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

// Until an order acts: up to a SYNC period until the SYNC, one that is interpolated, and the arm's own compliance.
constexpr std::size_t takes_effect_ms = 20;

class Judge {
 public:
  Judge(const Seen& seen, const Situation& situation, const Ending& ending, const SafetyFigures& figures)
      : moments_(seen.moments),
        motions_(seen.moments, situation, figures),
        seen_(seen),
        situation_(situation),
        ending_(ending),
        figures_(figures) {}

  Verdict verdict() {
    forces();
    if (!situation_.powering_up) goes_not_far();
    if (const auto deadline = strictest(); deadline && !taken_over()) {
      // What is reported before any drive runs is no stop: powering up has to end.
      situation_.powering_up && !runs_at(deadline->at_s) ? nothing_moves() : stop(*deadline);
    } else if (!deadline) {
      stopped_by_the_watch();
    }
    the_end();
    the_account();
    return verdict_;
  }

 private:
  const JointNames& names() const { return situation_.names; }
  JointBits all_joints() const { return static_cast<JointBits>((1U << names().size()) - 1); }
  std::size_t node_index(const std::string& node) const { return judge::node_index(node, names()); }

  void wrong(const std::string& what) { verdict_.wrong.push_back(what); }

  // Of all causes that have to stop the arm, the one by which it has to be stopped first.
  std::optional<Deadline> strictest() const {
    std::optional<Deadline> strictest;
    const std::size_t stops = static_cast<std::size_t>(
        std::count_if(situation_.causes.begin(), situation_.causes.end(), [this](const Cause& c) { return demands_stop(c); }));
    for (std::size_t i = 0; i < situation_.causes.size(); ++i) {
      const Cause& cause = situation_.causes[i];
      if (!demands_stop(cause) || (stops > 1 && never_heard(i))) continue;
      const Deadline deadline = delayed_by_a_cut(report_of(seen_, cause, situation_.begins_s[i], names(), figures_));
      if (!strictest || deadline.end_s() < strictest->end_s()) strictest = deadline;
    }
    // None of several was told: the last of them to begin has stopped the arm, or has to.
    if (!strictest && stops > 0) {
      std::size_t last = 0;
      for (std::size_t i = 0; i < situation_.causes.size(); ++i) {
        if (demands_stop(situation_.causes[i])) last = i;
      }
      strictest = delayed_by_a_cut(report_of(seen_, situation_.causes[last], situation_.begins_s[last], names(), figures_));
    }
    return strictest;
  }

  bool demands_stop(const Cause& cause) const { return cause.rule->demand == Demand::stop && !lost_on_its_way(cause); }

  // Another master's process data for a node whose process data are lost already: nobody hears them.
  bool lost_on_its_way(const Cause& cause) const {
    return cause.rule->kind == "foreign_rpdo" && has([&](const Cause& other) {
             return loses_process_data(other) && node_index(other.node) == node_index(cause.node) && begins_s(other) <= begins_s(cause);
           });
  }

  // The frame that tells of this cause was never sent, or came when the master heard nothing any more. Another cause has stopped the arm, or has to.
  bool never_heard(std::size_t index) const {
    const Cause& cause = situation_.causes[index];
    if (!told_by_a_frame(cause)) return false;
    const std::optional<double> told_s = told_by_a_frame_s(seen_, cause, situation_.begins_s[index]);
    if (!told_s) return true;
    for (std::size_t i = 0; i < situation_.causes.size(); ++i) {
      if (deafens_the_master(situation_.causes[i]) && *told_s > situation_.begins_s[i] - sync_s) return true;
    }
    return false;
  }

  // A stop that was due after the master was cut off reaches no drive: they stop when they miss the master's heartbeat.
  Deadline delayed_by_a_cut(Deadline deadline) const {
    for (std::size_t i = 0; i < situation_.causes.size(); ++i) {
      if (!cuts_off_the_master(situation_.causes[i]) || deadline.end_s() < situation_.begins_s[i]) continue;
      deadline.allowed_s = std::max(deadline.allowed_s, situation_.begins_s[i] + figures_.self_stop_s - deadline.at_s);
    }
    return deadline;
  }

  // Another master keeps the drives running, and nothing that ours sends arrives since before it could have told them to stop: only the drives' own chain
  // stops them. Where ours was cut off for longer than they take to miss it, they have stopped.
  bool taken_over() const {
    for (std::size_t i = 0; i < situation_.causes.size(); ++i) {
      for (std::size_t other = 0; other < situation_.causes.size(); ++other) {
        if (!cuts_off_the_master(situation_.causes[i]) || situation_.causes[other].rule->kind != "foreign_master") continue;
        const double second_s = seen_.second_master_s.value_or(situation_.begins_s[other]);
        const double cut_s = situation_.begins_s[i];
        if (cut_s <= second_s + figures_.stop_ms * ms && second_s < cut_s + figures_.self_stop_s) return true;
      }
    }
    return false;
  }

  template <class Is>
  bool has(Is is) const {
    return std::any_of(situation_.causes.begin(), situation_.causes.end(), is);
  }

  // Bit a joint.
  template <class Is>
  JointBits joints_that(Is is) const {
    JointBits bits = 0;
    for (const Cause& cause : situation_.causes) {
      const std::size_t joint = node_index(cause.node);
      if (is(cause) && joint < names().size()) bits |= static_cast<JointBits>(1u << joint);
    }
    return bits;
  }

  // The arm's ramp, which ends with its slowest joint's, and the time after it.
  double unreached_off_s(double from_s) const {
    double ramp_s = 0;
    const auto at = static_cast<std::size_t>(from_s / ms);
    for (std::size_t joint = 0; joint < names().size() && at < moments_.size(); ++joint)
      ramp_s = std::max(ramp_s, moments_[at].speed_rad_s[joint] / situation_.deceleration_rad_s2[joint]);
    return ramp_s + figures_.unreached_off_s;
  }

  // Their process data are lost both ways, and nothing else.
  JointBits joints_unreached() const {
    return static_cast<JointBits>(joints_that(loses_process_data) & joints_that(is_unheard) & ~joints_that(cut_off));
  }

  bool master_is_cut_off() const { return has(cuts_off_the_master); }

  void forces() {
    for (const Moment& moment : moments_) verdict_.force_n = std::max(verdict_.force_n, double(moment.force_n));
    if (verdict_.force_n > figures_.force_n) wrong(formatted("%.0f N of contact", verdict_.force_n));
  }

  // A drive that runs off and an encoder that stands report nothing: the core has to see that the joint is not where it should be. Of the joints that move the arm:
  // roll and jaw turn in their place, between their stops.
  void goes_not_far() {
    const JointBits misled = joints_that(misleads_its_joint);
    for (std::size_t joint = 0; joint + 1 < names().arm_joints() && !moments_.empty(); ++joint) {
      if ((misled >> joint & 1u) == 0) continue;
      double begin_s = HUGE_VAL;
      for (std::size_t i = 0; i < situation_.causes.size(); ++i) {
        const Cause& cause = situation_.causes[i];
        if (node_index(cause.node) == joint && misleads_its_joint(cause)) begin_s = std::min(begin_s, situation_.begins_s[i]);
      }
      const auto from = std::min(static_cast<std::size_t>(begin_s / ms), moments_.size() - 1);
      const auto by_angle = [joint](const Moment& a, const Moment& b) { return a.angle_rad[joint] < b.angle_rad[joint]; };
      const auto [low, high] = std::minmax_element(moments_.begin() + std::ptrdiff_t(from), moments_.end(), by_angle);
      const double gone_rad = double(high->angle_rad[joint]) - double(low->angle_rad[joint]);
      if (gone_rad > figures_.misled_rad) wrong(names()[joint] + formatted(" goes %.2f rad while its drive misleads", gone_rad));
    }
  }

  void stop(const Deadline& deadline) {
    const JointBits cut = joints_that(cut_off);
    // Whose process data are lost later has to hear of it; who is cut off hears no NMT either.
    const auto untold = static_cast<JointBits>(
        joints_that([&](const Cause& cause) { return loses_process_data(cause) && begins_s(cause) < deadline.end_s(); }) & ~cut);
    const auto told_to_run_s = [&](JointBits joints) {
      return last_s(moments_, deadline.at_s, [&](const Moment& m) { return (m.told_to_run & joints) != 0; });
    };
    const double on_bus_s = told_to_run_s(static_cast<JointBits>(~(cut | untold)));
    verdict_.stop_ms = (on_bus_s - deadline.at_s) / ms;
    if (on_bus_s > deadline.end_s() + ms) wrong(formatted("still told to run %.0f ms after the report", *verdict_.stop_ms));
    const bool halts = deadline.cause != nullptr && deadline.cause->rule->report == Report::halt;
    const JointBits unreached = joints_unreached();
    const double by_restart_s = told_to_run_s(unreached);
    if (by_restart_s > deadline.end_s() + unreached_off_s(deadline.end_s()) + ms)
      wrong(formatted("still runs unreached %.0f ms after the report", (by_restart_s - deadline.at_s) / ms));
    const double by_nmt_s = told_to_run_s(untold & static_cast<JointBits>(~unreached));
    const double late_s = halts ? figures_.unheeded_lowering_s : figures_.unheeded_stop_s;
    if (by_nmt_s > deadline.end_s() + late_s + ms)
      wrong(formatted("still runs without process data %.0f ms after the report", (by_nmt_s - deadline.at_s) / ms));
    const double from_s = std::min(on_bus_s, deadline.end_s());
    stands(from_s);
    loses_power(from_s, halts);
  }

  // No cause asks for a stop at a time of its own. A drive that says it is in fault does; and whatever ended the mission takes the power as a stop does.
  void stopped_by_the_watch() {
    if (!situation_.powering_up && seen_.drive_fault_s && runs_at(*seen_.drive_fault_s))
      return stop({nullptr, *seen_.drive_fault_s, figures_.stop_ms * ms});
    const double ran_s = last_s(moments_, 0, [](const Moment& m) { return m.told_to_run != 0; });
    if (!ending_.ended || ending_.holds || ran_s == 0) return;
    stands(ran_s);
    loses_power(ran_s, false);
  }

  double begins_s(const Cause& cause) const { return situation_.begins_s[static_cast<std::size_t>(&cause - situation_.causes.data())]; }

  void stands(double from_s) {
    const JointBits cut = joints_that(cut_off), untold = joints_that(loses_process_data);
    double standing_s = from_s;
    for (std::size_t joint = 0; joint < names().size(); ++joint) {
      const auto at = static_cast<std::size_t>(from_s / ms), bit = std::size_t{1} << joint;
      // A drive brakes from the SYNC on that follows the order: until then it does what it was told before.
      double speed = 0;
      for (std::size_t i = at; i < std::min(at + takes_effect_ms, moments_.size()); ++i)
        speed = std::max({speed, double(moments_[i].speed_rad_s[joint]), motions_.motor_speed_rad_s(i, joint)});
      // A drive that cannot be reached stops when it misses the master; one that loses its process data when NMT tells it.
      const double late_s = (cut & bit) != 0 ? figures_.self_stop_s : (untold & bit) != 0 ? figures_.unheeded_stop_s : 0;
      const double allowed_s = speed / situation_.deceleration_rad_s2[joint] + figures_.settling_s + late_s;
      const double unwound_s = from_s + allowed_s + figures_.unwinding_s;
      const double moved_s = last_s(moments_, from_s, [&](const Moment& m) { return motions_.moves(m, joint, unwound_s); });
      const double went_s = moved_s - from_s <= allowed_s ? moved_s : last_s(moments_, from_s, [&](const Moment& m) {
        return motions_.moves(m, joint, unwound_s) && !motions_.gives_way(m, joint, unwound_s);
      });
      stood_s_[joint] = went_s;
      standing_s = std::max(standing_s, moved_s);
      verdict_.gave_way = verdict_.gave_way || went_s < moved_s;
      if (went_s - from_s > allowed_s)
        wrong(names()[joint] + formatted(" moves %.2f s after the stop, %.2f s are allowed", went_s - from_s, allowed_s));
    }
    verdict_.standing_s = standing_s - from_s;
    verdict_.gripped = last_s(moments_, from_s, [this](const Moment& m) { return m.power == 0 && m.grip_n >= figures_.touch_n; }) > from_s;
  }

  void loses_power(double from_s, bool halts) {
    const double standing_s = stood_s(all_joints(), from_s);
    auto untold = static_cast<JointBits>(joints_that(loses_process_data) & ~joints_that(cut_off));
    const auto reachable = static_cast<JointBits>(master_is_cut_off() ? 0 : ~(joints_that(cut_off) | untold));
    const auto powered_s = [&](JointBits joints) {
      return last_s(moments_, from_s, [&](const Moment& m) { return (m.power & joints) != 0; });
    };
    const JointBits unreached = joints_unreached();
    if (!master_is_cut_off() && powered_s(unreached) - from_s > unreached_off_s(from_s) + ms)
      wrong(formatted("power is off %.2f s after the stop of a drive that nothing reaches", powered_s(unreached) - from_s));
    untold &= static_cast<JointBits>(~unreached);
    const double late_s = halts ? figures_.unheeded_lowering_s : figures_.unheeded_off_s;
    if (!master_is_cut_off() && powered_s(untold) - standing_s > figures_.off_after_standing_s + late_s + ms)
      wrong(formatted("power is off %.2f s after standing without process data", powered_s(untold) - standing_s));
    const double off_s = last_s(moments_, from_s, [](const Moment& m) { return m.power != 0; });
    verdict_.stop_to_off_s = off_s - from_s;
    verdict_.power_off_s = 0;
    const JointBits silenced = joints_silenced();
    const auto heard = static_cast<JointBits>(all_joints() & ~silenced);
    double late_off_s = loses_power_standing(reachable & heard, stood_s(heard, from_s), 0);
    for (std::size_t joint = 0; joint < names().size(); ++joint) {
      const auto bit = static_cast<JointBits>(1U << joint);
      if ((reachable & silenced & bit) != 0)
        late_off_s = std::max(late_off_s, loses_power_standing(bit, standing_s, from_s + ramp_s(joint)));
    }
    if (late_off_s > 0) wrong(formatted("power is off %.2f s after standing", late_off_s));
    if (*verdict_.stop_to_off_s > figures_.off_after_stop_s + ms)
      wrong(formatted("power is off %.2f s after the stop", *verdict_.stop_to_off_s));
  }

  // They stand since `stood_s`, and the master could not take them for standing before `ramp_over_s`. How long they keep their power, if that is too long; else 0.
  double loses_power_standing(JointBits joints, double stood_s, double ramp_over_s) {
    if (joints == 0) return 0;
    const double off_s = last_s(moments_, stood_s, [joints](const Moment& m) { return (m.power & joints) != 0; });
    verdict_.power_off_s = std::max(verdict_.power_off_s.value_or(0), off_s - stood_s);
    return off_s - std::max(stood_s, ramp_over_s) > figures_.off_after_standing_s + ms ? off_s - stood_s : 0;
  }

  // A drive holds a joint that swings in its gear until its ramp has ended.
  double stood_s(JointBits joints, double from_s) const {
    double stood_s = from_s;
    for (std::size_t joint = 0; joint < names().size(); ++joint) {
      if ((joints >> joint & 1U) != 0) stood_s = std::max(stood_s, stood_s_[joint]);
    }
    const double swung_s = last_s(moments_, from_s, [this, joints](const Moment& m) { return m.power != 0 && motions_.swings(m, joints); });
    return std::clamp(swung_s, stood_s, stood_s + figures_.settling_s);
  }

  // The master does not hear them, by what happened and not by what it did itself.
  JointBits joints_silenced() const {
    const auto silences_all = [](const Cause& cause) {
      return deafens_the_master(cause) || cause.rule->kind == "foreign_nmt" || cause.rule->kind == "foreign_reset";
    };
    return has(silences_all) ? all_joints() : joints_that(is_unheard);
  }

  // From the speed at which it was heard last, until it stands.
  double ramp_s(std::size_t joint) const {
    constexpr double speed_over_s = 0.02;  // the master's speed is that of its last positions
    double heard_s = seen_.last_heard_s[joint];
    for (const Cause& cause : situation_.causes) {
      if (deafens_the_master(cause)) heard_s = std::min(heard_s, begins_s(cause));
    }
    const auto first = static_cast<std::size_t>(std::max(0.0, heard_s - speed_over_s) / ms);
    const auto last = static_cast<std::size_t>(std::max(heard_s, ms) / ms);
    double speed = 0;
    for (std::size_t i = first; i <= last && i < moments_.size(); ++i) speed = std::max(speed, double(moments_[i].speed_rad_s[joint]));
    // The record begins with the first cause. Before that the joint may have been faster, by as much as it brakes in that time.
    const double deceleration_rad_s2 = situation_.deceleration_rad_s2[joint];
    speed += deceleration_rad_s2 * std::max(0.0, speed_over_s - heard_s);
    return std::max(0.0, speed - figures_.standing_rad_s) / deceleration_rad_s2;
  }

  bool runs_at(double t_s) const {
    const auto index = static_cast<std::size_t>(t_s / ms);
    return index < moments_.size() && moments_[index].told_to_run != 0;
  }

  // By the first cause that is no drive's own fault; nothing when there is none.
  template <class Is>
  std::optional<double> powering_up_ends_s(Is ends_it) const {
    std::optional<double> first_s;
    for (std::size_t i = 0; i < situation_.causes.size(); ++i) {
      const Cause& cause = situation_.causes[i];
      if (!ends_it(cause) || is_a_drives_fault(cause)) continue;
      const double end_s = report_of(seen_, cause, situation_.begins_s[i], names(), figures_).end_s();
      first_s = std::min(first_s.value_or(end_s), end_s);
    }
    return first_s;
  }

  void nothing_moves() {
    // What has rebooted is booted again.
    const auto ends_it = [this](const Cause& cause) { return demands_stop(cause) && cause.rule->kind != "reboot"; };
    if (!has(ends_it)) return;
    // While a drive's fault is reset the others are enabled. One of them that runs off is a fault of its own: it loses its power in the time of a stop.
    const std::optional<double> ends_s = powering_up_ends_s(ends_it);
    const bool others_are_enabled = !ends_s;
    if (ends_s && !master_is_cut_off()) {
      const double powered_s = last_s(moments_, *ends_s, [](const Moment& m) { return m.power != 0; });
      if (powered_s > *ends_s + figures_.off_after_standing_s)
        wrong(formatted("power is on %.2f s after powering up had to end", powered_s - *ends_s));
    }
    const JointBits runs_off =
        others_are_enabled ? joints_that([](const Cause& cause) { return cause.rule->kind == "runaway"; }) : JointBits{0};
    for (std::size_t joint = 0; joint < names().size(); ++joint) {
      // Without power the joints settle in their gears.
      const auto moves = [&](const Moment& m) { return m.power != 0 && motions_.moves(m, joint, 0); };
      const double moved_s = last_s(moments_, 0, moves);
      if (moved_s == 0) continue;
      const double since_s = motions_.time_s(*std::find_if(moments_.begin(), moments_.end(), moves));
      // It was enabled while the fault was still on its way to the core.
      if (ends_s && since_s < *ends_s && moved_s <= *ends_s + figures_.settling_s) continue;
      if ((runs_off >> joint & 1u) != 0 && moved_s - since_s <= figures_.off_after_stop_s) continue;
      wrong(names()[joint] + formatted(" moves from %.2f to %.2f s although powering up had to end", since_s, moved_s));
    }
  }

  // However it ended, the arm stands and has no power, unless the core says that it holds the arm.
  void the_end() {
    if (moments_.empty()) return wrong("nothing was seen");
    const bool must_end = ending_.expected_to_end;
    if (!ending_.ended && must_end) wrong("it did not end");
    constexpr std::size_t tail = 200;  // ms
    const std::size_t from = moments_.size() > tail ? moments_.size() - tail : 0;
    // What waits for orders has done the last one.
    if (!ending_.ended && !must_end && motions_.travels(from)) wrong("the arm moves and no order moves it");
    if (!ending_.ended) return;
    const bool powered = std::any_of(moments_.begin() + std::ptrdiff_t(from), moments_.end(), [](const Moment& m) { return m.power != 0; });
    if (motions_.travels(from) && !taken_over()) wrong("the arm moves after the end");
    if (powered && !ending_.holds && !taken_over()) wrong("power is on after the end");
    // What a joint that misleads drives the arm into on the way back, after it was told, is its own doing.
    const bool told_for_nothing = (ending_.told_s || !ending_.held_s) && touches_nothing(ending_.told_s);
    const bool held_for_nothing = ending_.held_s && touches_nothing(ending_.held_s);
    const bool for_nothing = ending_.holds && !situation_.over && (told_for_nothing || held_for_nothing);
    verdict_.stood_anyway = for_nothing && stood_where_it_was_to_stay();
    if (for_nothing && !verdict_.stood_anyway) wrong("held under power for a contact that is none, with a drive that misleads");
  }

  // A contact was told, or holds the arm, and nothing but drives that mislead can have made one: when it was told, the arm touched nothing.
  bool touches_nothing(std::optional<double> told_s) const {
    const auto makes_one = [](const Cause& c) { return c.rule->kind == "obstacle" || c.rule->kind == "handle_breaks"; };
    return std::any_of(situation_.causes.begin(), situation_.causes.end(), misleads) &&
           std::none_of(situation_.causes.begin(), situation_.causes.end(), makes_one) && force_until_n(told_s) < figures_.touch_n;
  }

  // The largest from shortly before. What the jaw held earlier says nothing of it.
  double force_until_n(std::optional<double> when_s) const {
    const double told_s = when_s.value_or(static_cast<double>(moments_.size()) * ms);
    double force_n = 0;
    for (const Moment& moment : moments_) {
      const double t_s = motions_.time_s(moment);
      if (t_s >= told_s - figures_.touched_within_s && t_s <= told_s) force_n = std::max(force_n, double(moment.force_n));
    }
    return force_n;
  }

  // The only drive that misleads is a joint that seized, and its set-point has hardly moved since: within the two counts by which rounding and a drive that holds
  // differ.
  bool stood_where_it_was_to_stay() const {
    const auto& causes = situation_.causes;
    const auto misled = std::find_if(causes.begin(), causes.end(), misleads);
    if (std::count_if(causes.begin(), causes.end(), misleads) != 1 || misled->rule->kind != "following") return false;
    const std::size_t joint = node_index(misled->node);
    if (joint >= names().size() || names_another(joint)) return false;
    const auto& told = seen_.told_to_go[joint];
    return told && double(told->second) - double(told->first) <= 2 * situation_.units_per_count[joint];
  }

  // In the reason, without the advice in brackets.
  bool names_another(std::size_t joint) const {
    const std::string said = ending_.reason.substr(0, ending_.reason.find('('));
    for (std::size_t other = 0; other < names().size(); ++other) {
      if (other != joint && said.find(names()[other]) != std::string::npos) return true;
    }
    return false;
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
    const bool told_of_contact =
        ending_.reason.starts_with("unexpected contact") || ending_.reason.find("touched something") != std::string::npos;
    const bool named =
        std::any_of(situation_.causes.begin(), situation_.causes.end(), [&](const Cause& c) { return c.named_in(ending_.reason); });
    const bool for_nothing = told_of_contact && touches_nothing(ending_.told_s);
    verdict_.stood_anyway = verdict_.stood_anyway || (for_nothing && stood_where_it_was_to_stay());
    if (named && (!for_nothing || verdict_.stood_anyway)) return;
    verdict_.unclear.push_back("the reason does not name the cause: " + (ending_.reason.empty() ? "none is given" : ending_.reason));
  }

  const std::vector<Moment>& moments_;
  const JointMotions motions_;
  const Seen& seen_;
  const Situation& situation_;
  const Ending& ending_;
  const SafetyFigures& figures_;
  Verdict verdict_;
  PerJoint<double> stood_s_{};  // since when each does
};

}  // namespace

Verdict judge(const Seen& seen, const Situation& situation, const Ending& ending, const SafetyFigures& figures) {
  return Judge(seen, situation, ending, figures).verdict();
}

}  // namespace lf::judge
