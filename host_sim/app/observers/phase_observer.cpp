#include "host_sim/app/observers/phase_observer.hpp"

#include <cstdio>

#include "hal/config/fault_text.hpp"

namespace lf::app {

namespace {

std::string clock_text(double s) {
  char text[32];
  std::snprintf(text, sizeof text, "%7.2f s  ", s);
  return text;
}

}  // namespace

void PhaseObserver::on_telemetry(const Telemetry& telemetry) {
  for (const Event& event : telemetry.events) on_event(event, telemetry.sight);
}

void PhaseObserver::on_event(const Event& event, const mission::Sight& sight) {
  const mission::StepRow& step = mission::row(event.step);
  char text[160];
  std::snprintf(text, sizeof text, "%d %s %s %s %d %d %.17g", int(event.kind), step.name,
                event.fault == safety::Fault::count ? "-" : safety::name(event.fault), safety::name(event.reaction), event.task, event.code,
                event.value);
  digest_.decision(event.t, text);
  if (event.kind == Event::Kind::step) enter_step(event);
  if (event.kind == Event::Kind::emcy && event.emcy != 0 && say_) {
    say_(clock_text(event.t.s()) + "node " + std::to_string(event.code) + ": " + texts_.of_node(event.code, event.emcy));
  }
  if (event.kind != Event::Kind::fault || event.reaction < safety::Reaction::retry) return;
  if (event.reaction == safety::Reaction::retry) retried_ = true;
  if (event.reaction > safety::Reaction::retry) given_up_ = event.fault == safety::Fault::aborted ? "aborted" : "failed";
  if (say_)
    say_(clock_text(event.t.s()) + step.name + ": " + config::fault_text(event.fault, event.code, event.emcy, texts_, sight) +
         ", reaction: " + safety::name(event.reaction));
}

void PhaseObserver::enter_step(const Event& event) {
  const mission::StepRow& step = mission::row(event.step);
  if (event.step == mission::Step::next_task && !phases_.empty()) return;  // a decision of one tick
  if (!phases_.empty() && phases_.back().name == step.stage) return;
  if (!phases_.empty()) {
    phases_.back().end_s = event.t.s();
    phases_.back().outcome = outcome();
    if (say_) say_(clock_text(phases_.back().end_s) + phases_.back().name + ": " + phases_.back().outcome);
  }
  phases_.push_back({step.stage, event.t.s(), record::unknown, ""});
  retried_ = false;
  given_up_.clear();
}

std::string PhaseObserver::outcome() const { return !given_up_.empty() ? given_up_ : retried_ ? "retried" : "done"; }

void PhaseObserver::finish(double now_s, const std::string& failure) {
  if (phases_.empty()) return;
  phases_.back().end_s = now_s;
  phases_.back().outcome = failure.empty() ? outcome() : "failed";
}

}  // namespace lf::app
