#include "host_sim/app/observers/event_observer.hpp"

#include "hal/config/event_json.hpp"
#include "hal/config/fault_text.hpp"

namespace lf::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr Duration counters_every = Duration::from_ms(500);  // as the daemon does

record::FaultRecord record_of(const Event& event, const config::ErrorTexts& texts, const mission::Sight& sight) {
  record::FaultRecord fault;
  fault.t_s = fault.last_s = config::json_seconds(event.t);
  fault.step = mission::row(event.step).name;
  if (event.kind == Event::Kind::emcy) {
    fault.fault = "emcy";
    fault.text = "node " + std::to_string(event.code) + ": " +
                 (event.emcy == 0 ? std::string("no error any more") : texts.of_node(event.code, event.emcy));
    return fault;
  }
  fault.fault = safety::name(event.fault);
  fault.text = config::fault_text(event.fault, event.code, event.emcy, texts, sight);
  fault.reaction = safety::name(event.reaction);
  return fault;
}

bool alike(const record::FaultRecord& a, const record::FaultRecord& b) {
  return a.step == b.step && a.fault == b.fault && a.text == b.text && a.reaction == b.reaction;
}

}  // namespace

EventObserver::EventObserver(RunFiles& files, const config::ErrorTexts& texts) : files_(files), texts_(texts) {
  if (files_.wanted()) log_.emplace(files_.path("log.jsonl"));
}

void EventObserver::on_telemetry(const Telemetry& telemetry) {
  for (const Event& event : telemetry.events) {
    say(config::event_json(event, texts_, telemetry.sight));
    if (event.kind == Event::Kind::fault || event.kind == Event::Kind::emcy) keep(event, telemetry.sight);
  }
  last_ = telemetry;
  if (telemetry.t >= next_counters_) tell_counters(telemetry);
}

void EventObserver::keep(const Event& event, const mission::Sight& sight) {
  record::FaultRecord fault = record_of(event, texts_, sight);
  if (!faults_.empty() && alike(faults_.back(), fault)) {
    ++faults_.back().times;
    faults_.back().last_s = fault.t_s;
  } else if (faults_.size() < record::most_faults) {
    faults_.push_back(std::move(fault));
  } else {
    ++left_out_;
  }
}

void EventObserver::tell_counters(const Telemetry& telemetry) {
  next_counters_ = telemetry.t + counters_every;
  Json counters{{"faults", config::fault_counts_json(telemetry.faults)}};
  if (telemetry.rejected_inputs > 0) counters["inputs rejected"] = telemetry.rejected_inputs;
  if (counters == counters_) return;
  counters_ = counters;
  say({{"t_s", config::json_seconds(telemetry.t)}, {"kind", "counted"}, {"counters", counters}});
}

void EventObserver::say(const Json& line) {
  if (!log_) return;
  if (!log_->write(line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n")) files_.lost(log_->error());
}

void EventObserver::say_end(const Json& line) {
  tell_counters(last_);
  say(line);
}

void EventObserver::finish() {
  if (log_ && !log_->close()) files_.lost(log_->error());
}

}  // namespace lf::app
