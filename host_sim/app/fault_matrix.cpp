#include "host_sim/app/fault_matrix.hpp"

#include <algorithm>
#include <map>

#include "hal/config/fault_text.hpp"
#include "hal/sim/observers.hpp"
#include "host_sim/app/copies.hpp"
#include "host_sim/app/interrupt.hpp"
#include "host_sim/judge/truth.hpp"
#include "host_sim/scenario/draw.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

judge::BusNodes bus_of(const scenario::Scenario& scenario) {
  judge::BusNodes bus;
  bus.names = scenario.joints;
  bus.numbers.clear();
  for (std::size_t i = 0; i < scenario.told_arm.joint_count(); ++i)
    bus.numbers.push_back(static_cast<std::uint8_t>(config::drive_of(scenario.drives, i).node));
  bus.numbers.push_back(static_cast<std::uint8_t>(scenario.drives.output_node));
  return bus;
}

namespace {

using mission::Step;

constexpr double after_end_s = 2.5;  // watched on, past every time that a stop may take
constexpr double longest_s = 300;    // of a mission, after its fault
constexpr double by_hand_s = 6;      // of an arm that waits for orders
constexpr double over_s = 3;         // of a mission that had ended before

struct Watched {
  explicit Watched(const scenario::Scenario& scenario) : safety(bus_of(scenario).numbers) {}

  judge::SafetyObserver safety;
  judge::TruthObserver truth;
  hal::SimObservers all{&safety, &truth};
};

judge::Ending ending_of(const Flight& flight, const Watched& watched, const MatrixRow& row, const world::World& world, Time begin,
                        bool over) {
  const mission::Outcome& outcome = flight.mission().outcome();
  judge::Ending ending;
  ending.ended = outcome.ended;
  ending.success = outcome.ended && outcome.success;
  ending.step = mission::row(flight.mission_step()).name;
  if (ending.ended && !ending.success)
    ending.reason = config::fault_text(outcome.fault, outcome.code, outcome.emcy, flight.error_texts(), flight.mission().sight());
  ending.holds = flight.mission_step() == Step::held;
  const bool must_stop = std::any_of(row.causes.begin(), row.causes.end(), [](const judge::Cause& cause) {
    return cause.rule->demand == judge::Demand::stop || cause.rule->kind == "runaway";
  });
  ending.expected_to_end = row.moment.walk != "by hand" || must_stop;
  if (!ending.success) return ending;
  const auto& results = flight.mission().tasks();
  const auto wrong = [&](const world::ContactReport& contacts) {
    return judge::contradiction({results.data(), results.size()}, watched.truth.watched(world), contacts, flight.panel_names());
  };
  world::ContactReport contacts = world.contacts();
  if (over) std::erase_if(contacts.unintended, [&](const world::UnintendedContact& touch) { return touch.first_s >= begin.s(); });
  if (const auto contradiction = wrong(contacts)) ending.contradicted = contradiction->reason;
  return ending;
}

// An arm may be pushed where none of its drives can feel it. That it calls a success then is no lie, but the row says so.
bool unfelt_push(const Flight& flight, const Watched& watched, const MatrixRow& row, const world::World& world) {
  const bool pushed =
      std::any_of(row.causes.begin(), row.causes.end(), [](const judge::Cause& cause) { return cause.rule->kind == "obstacle"; });
  if (!pushed) return false;
  const scene::BodyId obstacle = scene::OwnBodies(flight.arm_joints()).obstacle();
  const auto& results = flight.mission().tasks();
  world::ContactReport contacts = world.contacts();
  std::erase_if(contacts.unintended,
                [obstacle](const world::UnintendedContact& touch) { return touch.a == obstacle || touch.b == obstacle; });
  if (judge::contradiction({results.data(), results.size()}, watched.truth.watched(world), contacts, flight.panel_names())) return false;
  return !judge::felt_a_push(watched.safety.seen());
}

// Makes the row's faults and flies on to the end.
RowResult fly_row(const config::Drives& drives, Flight& flight, Watched& watched, FaultWalk& walk, const MatrixRow& row) {
  judge::Situation situation;
  situation.causes = row.causes;
  situation.names = flight.error_texts().names();
  situation.deceleration_rad_s2 = flight.deceleration_rad_s2();
  situation.gear_gives_rad = flight.gear_gives_rad();
  situation.slips_rad = flight.slips_rad();
  situation.units_per_count = flight.units_per_count();
  situation.powering_up = mission::row(row.moment.step).phase == safety::Phase::boot;
  situation.over = flight.mission().outcome().ended;
  situation.fails_anyway = !walk.succeeds() && !walk.by_hand();
  const Time begin = flight.now();
  const auto counts_before = flight.fault_counts();
  watched.safety.begin(flight.platform().devices(), begin);
  for (std::size_t i = 0; i < row.causes.size(); ++i) {
    const double later_s = i == 0 ? 0 : row.apart_s;
    situation.begins_s.push_back(later_s);
    config::Fault fault = row.causes[i].fault();
    if (fault.kind == "limits_refused") continue;  // it has been told
    fault.at_s = begin.s() + later_s;
    flight.platform().add_fault(scenario::sim_fault(fault, drives, flight.error_texts().names()));
  }
  const double limit_s = situation.over                                                                 ? over_s
                         : walk.by_hand() && mission::row(row.moment.step).phase == safety::Phase::free ? by_hand_s
                                                                                                        : longest_s;
  // An end may lead to another one: what held the arm may take its power.
  mission::Step end = flight.mission().step();
  double ended_s = situation.over ? limit_s - after_end_s : longest_s;
  auto told = std::pair(flight.mission().outcome().fault, flight.mission().outcome().code);
  std::optional<double> told_s, held_s;
  while (true) {
    const double now_s = (flight.now() - begin).s();
    const auto tells = std::pair(flight.mission().outcome().fault, flight.mission().outcome().code);
    if (tells != told) told_s = now_s;
    told = tells;
    if (flight.mission_step() != mission::Step::held)
      held_s.reset();
    else if (!held_s)
      held_s = now_s;
    if (flight.mission().outcome().ended && flight.mission().step() != end) {
      end = flight.mission().step();
      ended_s = std::max(situation.over ? ended_s : 0, now_s);
    }
    const bool ended = flight.mission().outcome().ended;
    if (now_s >= (ended ? ended_s + after_end_s : limit_s)) break;
    walk.give_orders(flight);
    flight.step();
  }
  judge::Ending ending = ending_of(flight, watched, row, flight.platform().world(), begin, situation.over);
  ending.told_s = told_s;
  ending.held_s = held_s;
  const bool unfelt = !ending.contradicted.empty() && unfelt_push(flight, watched, row, flight.platform().world());
  if (unfelt) ending.contradicted.clear();
  judge::SafetyFigures figures;
  if (flight.has_own_drives()) figures.self_stop_s = judge::by_deadline_s;
  const judge::Verdict verdict = judge::judge(watched.safety.seen(), situation, ending, figures);
  RowResult result;
  result.wrong = verdict.wrong;
  result.unclear = verdict.unclear;
  result.unfelt = unfelt;
  result.stood_anyway = verdict.stood_anyway;
  result.gripped = verdict.gripped;
  result.gave_way = verdict.gave_way;
  result.false_success = verdict.false_success;
  result.went_on = verdict.went_on;
  result.end = ending.ended ? ending.step : "not ended, in " + ending.step;
  result.reason = ending.reason;
  for (std::size_t i = 0; i < safety::fault_count; ++i) {
    if (flight.fault_counts()[i] != counts_before[i]) result.reported.emplace_back(safety::name(static_cast<safety::Fault>(i)));
  }
  result.stop_ms = verdict.stop_ms;
  result.standing_s = verdict.standing_s;
  result.power_off_s = verdict.power_off_s;
  result.stop_to_off_s = verdict.stop_to_off_s;
  result.force_n = verdict.force_n;
  return result;
}

RowResult described(const MatrixRow& row, RowResult result) {
  result.row = row.name();
  for (const judge::Cause& cause : row.causes) result.kind += (result.kind.empty() ? "" : " + ") + cause.rule->kind;
  result.step = row.moment.name;
  result.walk = row.moment.walk;
  result.at_s = row.moment.at_s;
  // A mission that waits for an operator, or had ended, has no success to come to.
  result.must_go_on = FaultWalk(row.moment.walk).succeeds() && !mission::is_end(row.moment.step) &&
                      std::all_of(row.causes.begin(), row.causes.end(),
                                  [](const judge::Cause& cause) { return cause.rule->demand == judge::Demand::go_on; });
  return result;
}

// Rows of one walk, in the order of their times.
void fly_walk(const scenario::Scenario& base, const std::string& name, const std::vector<const MatrixRow*>& rows, Copies& copies) {
  FaultWalk walk(name);
  Watched watched(base);
  Flight flight(walk.with_its_faults(base), 1, watched.all);
  for (const MatrixRow* row : rows) {
    while (flight.now().s() < row->moment.at_s && !interrupted()) {
      walk.give_orders(flight);
      flight.step();
    }
    if (interrupted()) return;
    copies.start(row->name(), [&] { return row_json(described(*row, fly_row(base.drives, flight, watched, walk, *row))); });
  }
}

// What the core is told before it starts cannot be made on the way.
void fly_from_power_on(const scenario::Scenario& base, const MatrixRow& row, Copies& copies) {
  copies.start(row.name(), [&] {
    FaultWalk walk(row.moment.walk);
    scenario::Scenario told = walk.with_its_faults(base);
    for (const judge::Cause& cause : row.causes) told.faults.push_back(cause.fault());
    Watched watched(base);
    Flight flight(told, 1, watched.all);
    walk.give_orders(flight);
    flight.step();
    return row_json(described(row, fly_row(base.drives, flight, watched, walk, row)));
  });
}

// From power-on, in a process of its own. What is seen takes other times than what is given: the moment counts from when the step begins.
void fly_rendered(const scenario::Scenario& base, const MatrixRow& row, Copies& copies) {
  copies.start(row.name(), [&] {
    FaultWalk walk(row.moment.walk);
    Watched watched(base);
    Flight flight(walk.with_its_faults(base), 1, watched.all, Sight::rendered);
    double begun_s = -1;
    while (begun_s < 0 || flight.now().s() < begun_s + row.moment.into_s) {
      if (flight.now().s() > longest_s) throw InputError("the mission did not come to this step");
      walk.give_orders(flight);
      flight.step();
      if (begun_s < 0 && flight.mission_step() == row.moment.step) begun_s = flight.now().s();
    }
    return row_json(described(row, fly_row(base.drives, flight, watched, walk, row)));
  });
}

}  // namespace

void fly_matrix(const scenario::Scenario& base, const std::vector<MatrixRow>& rows, Sight sight, int jobs,
                const std::filesystem::path& file, const std::function<void(const RowResult&)>& told) {
  LineFile lines(file);
  std::map<std::string, const MatrixRow*> by_name;
  for (const MatrixRow& row : rows) by_name[row.name()] = &row;
  Copies copies(jobs, [&](const Copies::Ended& ended) {
    std::optional<RowResult> result = parse_row(ended.line);
    if (!result) {
      result.emplace();
      result->wrong = {ended.failure};
      result = described(*by_name.at(ended.name), *result);
    }
    lines.append(row_json(*result));
    told(*result);
  });
  for (const std::string& walk : FaultWalk::names()) {
    std::vector<const MatrixRow*> on_the_way;
    for (const MatrixRow& row : rows) {
      if (row.moment.walk != walk) continue;
      const bool is_told =
          std::any_of(row.causes.begin(), row.causes.end(), [](const judge::Cause& cause) { return cause.rule->kind == "limits_refused"; });
      if (is_told) {
        fly_from_power_on(base, row, copies);
      } else if (sight == Sight::rendered) {
        if (!interrupted()) fly_rendered(base, row, copies);
      } else {
        on_the_way.push_back(&row);
      }
    }
    std::stable_sort(on_the_way.begin(), on_the_way.end(),
                     [](const MatrixRow* a, const MatrixRow* b) { return a->moment.at_s < b->moment.at_s; });
    if (!on_the_way.empty() && !interrupted()) fly_walk(base, walk, on_the_way, copies);
  }
  copies.finish();
}

}  // namespace lf::app
