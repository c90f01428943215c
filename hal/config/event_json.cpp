#include "hal/config/event_json.hpp"

#include <cmath>

#include "hal/config/cause.hpp"
#include "hal/config/fault_text.hpp"

namespace lf::config {

namespace {

using Json = nlohmann::ordered_json;

const char* kind_of(Event::Kind kind) {
  switch (kind) {
    case Event::Kind::step: return "step";
    case Event::Kind::fault: return "fault";
    case Event::Kind::located: return "located";
    case Event::Kind::task_done: return "task done";
    case Event::Kind::task_failed: return "task failed";
    case Event::Kind::emcy: return "emcy";
  }
  return "event";
}

}  // namespace

Json fit_json(const mission::CalibrationFit& fit, const mission::TaskResults& results) {
  Json json = Json::object();
  if (fit.known) {
    json["marker_side_percent"] = 100 * static_cast<double>(fit.marker_side_error);
    json["marker_corners_mm"] = 1e3 * static_cast<double>(fit.marker_corners_m);
    json["plane_bend_mm"] = 1e3 * static_cast<double>(fit.plane_bend_m);
    if (std::isfinite(fit.panel_shift_m)) json["panel_shift_mm"] = 1e3 * static_cast<double>(fit.panel_shift_m);
  }
  if (const std::optional<double> off_m = faces_off_m(results)) json["faces_off_mm"] = 1e3 * *off_m;
  const Cause doubt = calibration_cause(fit, results);
  if (!doubt.name.empty()) json["doubt"] = doubt.name;
  if (!doubt.remedy.empty()) json["remedy"] = doubt.remedy;
  return json;
}

Json cause_json(safety::Fault fault, std::int32_t code, const mission::Sight& sight) {
  Json json = Json::object();
  const Cause cause = cause_of(fault, code, sight);
  if (!cause.name.empty()) json["cause"] = cause.name;
  if (!cause.remedy.empty()) json["remedy"] = cause.remedy;
  if (fault == safety::Fault::vision_poor && sight.look != 0) json["seen"] = sight_text(sight);
  return json;
}

Json event_json(const Event& event, const ErrorTexts& texts, const mission::Sight& sight) {
  Json json;
  json["t_s"] = json_seconds(event.t);
  json["kind"] = kind_of(event.kind);
  json["step"] = mission::row(event.step).name;
  if (event.kind == Event::Kind::fault) {
    json["fault"] = safety::name(event.fault);
    json["reaction"] = safety::name(event.reaction);
    json["code"] = event.code;
    json["text"] = fault_text(event.fault, event.code, event.emcy, texts, sight);
    if (event.fault == safety::Fault::step_failed || event.fault == safety::Fault::vision_poor)
      json["because"] = lf::name(static_cast<StepFailure>(event.code));
    json.update(cause_json(event.fault, event.code, sight));
  }
  if (event.kind == Event::Kind::emcy) {
    json["node"] = event.code;
    json["emcy"] = event.emcy;
    json["text"] = texts.of_node(event.code, event.emcy);
  }
  if (event.kind == Event::Kind::located) {
    json["handle_deg"] = deg_from_rad(event.value);
    if (sight.fit.known) json["fit"] = fit_json(sight.fit, {});
  }
  if (event.kind == Event::Kind::task_done || event.kind == Event::Kind::task_failed) {
    json["task"] = event.task;
    json["value"] = event.value;
  }
  return json;
}

Json fault_counts_json(const std::array<std::uint32_t, safety::fault_count>& counts) {
  Json json = Json::object();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > 0) json[safety::name(static_cast<safety::Fault>(i))] = counts[i];
  }
  return json;
}

}  // namespace lf::config
