// What the operator asks of the daemon.
#include <cerrno>
#include <cstring>

#include "hal/config/homing_file.hpp"
#include "hal/config/machine.hpp"
#include "hal/vehicle/can_restart.hpp"
#include "hal/vehicle/daemon.hpp"
#include "shared/input_error.hpp"

namespace lf::hal {

namespace {

// A control period is 4 ms; a machine that is busy takes some more.
constexpr Duration answer_within = Duration::from_ms(500);

Json refused(const std::string& why) { return {{"ok", false}, {"why", why}}; }

std::optional<Command> command_of(const std::string& request) {
  if (request == "start") return Command::start;
  if (request == "home") return Command::home;
  if (request == "hold") return Command::hold;
  if (request == "resume") return Command::resume;
  if (request == "abort") return Command::abort;
  if (request == "reset") return Command::reset;
  if (request == "jog") return Command::jog;
  if (request == "task") return Command::set_tasks;
  if (request == "estop") return Command::emergency_stop;
  return std::nullopt;
}

bool read_jog(const Json& arguments, mission::Order& order, std::string& why) {
  const Json joint = arguments.value("joint", Json());
  const Json by = arguments.value("by_deg", Json());
  if (!joint.is_string() || !by.is_number()) {
    why = "jog takes \"joint\" and \"by_deg\"";
    return false;
  }
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (joint.get<std::string>() != config::joint_name(i)) continue;
    order.joint = static_cast<Joint>(i);
    order.by_rad = rad_from_deg(by.get<double>());
    return true;
  }
  why = "no joint '" + joint.get<std::string>() + "': slew, shoulder, elbow, roll or jaw";
  return false;
}

config::Task read_task(const Json& json) {
  config::Task task;
  if (json.is_object() && json.size() == 1 && json.contains("turn_valve") && json["turn_valve"].value("to_deg", Json()).is_number()) {
    task.kind = config::Task::Kind::turn_valve;
    task.to_deg = json["turn_valve"]["to_deg"].get<double>();
    return task;
  }
  if (!json.is_object() || json.size() != 1 || !json.contains("press_buttons") || !json["press_buttons"].value("order", Json()).is_array())
    throw InputError("a task is {\"turn_valve\": {\"to_deg\": N}} or {\"press_buttons\": {\"order\": [left, centre, right]}}");
  task.kind = config::Task::Kind::press_buttons;
  task.order.clear();
  for (const Json& button : json["press_buttons"]["order"]) {
    const std::string name = button.is_string() ? button.get<std::string>() : "";
    if (name != "left" && name != "centre" && name != "right") throw InputError("no button '" + name + "': left, centre or right");
    task.order.push_back(name);
  }
  return task;
}

bool read_tasks(const Json& arguments, mission::Order& order, std::string& why) {
  const Json list = arguments.value("tasks", Json());
  if (!list.is_array()) {
    why = "task takes \"tasks\", a list";
    return false;
  }
  try {
    std::vector<config::Task> tasks;
    for (const Json& task : list) tasks.push_back(read_task(task));
    order.tasks = config::core_tasks(tasks, "task");
    return true;
  } catch (const InputError& error) {
    why = error.what();
    return false;
  }
}

// Of an order that the mission's standing allows, and that was refused all the same.
const char* why_not(Command command) {
  switch (command) {
    case Command::start: return "a joint stands outside its limits: jog it back first";
    case Command::jog: return "it leads out of the joint's limits, is larger than 20 deg, or another order is being taken";
    default: return "its numbers are out of bounds";
  }
}

}  // namespace

bool Daemon::order_of(const std::string& request, const Json& arguments, mission::Order& order, std::string& why) const {
  const std::optional<Command> command = command_of(request);
  if (!command) {
    why = "no request '" + request + "'";
    return false;
  }
  order.command = *command;
  if (*command == Command::jog) return read_jog(arguments, order, why);
  if (*command == Command::set_tasks) return read_tasks(arguments, order, why);
  return true;
}

std::string Daemon::answer(const std::string& line, Role role) {
  const Json request = Json::parse(line, nullptr, false);
  Json reply;
  const std::string what =
      request.is_object() && request.contains("do") && request["do"].is_string() ? request["do"].get<std::string>() : "";
  const Right* right = right_of(what);
  if (what.empty()) {
    reply = refused("a request is a JSON object such as {\"do\": \"status\"}");
  } else if (right == nullptr) {
    reply = refused("no request '" + what + "'");
  } else if (role < right->least) {
    reply = refused(std::string(name(role)) + " may not '" + what + "': it takes " + name(right->least));
  } else {
    reply = carry_out(what, request);
  }
  if (what != "status")
    writer_.say({{"t_s", monotonic_now().s()},
                 {"kind", "order"},
                 {"order", request.is_discarded() ? Json(line) : request},
                 {"by", name(role)},
                 {"answer", reply}});
  return reply.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json Daemon::carry_out(const std::string& request, const Json& arguments) {
  if (request == "status") {
    Json reply = status();
    reply["ok"] = true;
    return reply;
  }
  if (request == "restart-bus") {
    const int error = restart_can(config_.interface);
    return error == 0 ? Json{{"ok", true}} : refused(config_.interface + " was not restarted: " + std::strerror(error));
  }
  mission::Order order;
  if (std::string why; !order_of(request, arguments, order, why)) return refused(why);
  return give_order(order);
}

Json Daemon::give_order(const mission::Order& order) {
  send_order(order);
  const Time end = monotonic_now() + answer_within;
  while (monotonic_now() < end) {
    for (OrderAnswer answer; loop_rings_.answers.pop(answer);) {
      if (answer.number != orders_sent_) continue;
      Json reply{{"ok", answer.taken}, {"standing", mission::name(answer.standing)}};
      if (answer.taken) return reply;
      const bool possible = mission::may(order.command, answer.standing);
      reply["why"] = possible ? why_not(order.command) : std::string("not while the mission is ") + mission::name(answer.standing);
      return reply;
    }
    sleep_until(monotonic_now() + Duration::from_ms(1));
  }
  return refused("the control thread does not answer");
}

Json Daemon::latencies() const {
  return {{"wake_up_us", histogram_json(platform_.clock().lateness())},
          {"tick_us", histogram_json(control_.tick_latency())},
          {"tick_cpu_us", histogram_json(control_.tick_work())},
          {"image_us", histogram_json(vision_.image_latency())}};
}

Json Daemon::status() const {
  const LogWriter::Newest now = writer_.newest();
  Json json = status_json(now.control, now.telemetry);
  json["interface"] = config_.interface;
  json["latency"] = latencies();
  json["ticks"] = now.control.ticks;
  json["core"] = {{"heap_calls", now.control.heap_calls}, {"page_faults", now.control.page_faults}, {"realtime", now.control.realtime}};
  json["lost"] = lost_;
  json["camera"] = {{"images", now.camera.images}, {"status", now.camera.status > 0 ? std::strerror(now.camera.status) : "ok"}};
  json["frames"] = {{"received", now.control.can.received}, {"sent", now.control.can.sent}};
  json["counters"] = counters_json(now.control, now.camera, now.telemetry);
  if (const std::string trouble = writer_.trouble(); !trouble.empty()) json["log"] = trouble;
  return json;
}

std::string Daemon::summary() const {
  const LogWriter::Newest now = writer_.newest();
  std::string text;
  const auto add = [&text](const char* what, const LatencyHistogram& h) {
    char line[160];
    std::snprintf(line, sizeof line, "%-18s p50 %7.1f us, p99 %7.1f us, p99.9 %7.1f us, max %8.1f us of %llu\n", what, h.percentile_us(0.5),
                  h.percentile_us(0.99), h.percentile_us(0.999), h.max_us(), static_cast<unsigned long long>(h.count()));
    text += line;
  };
  add("wake-up lateness", platform_.clock().lateness());
  add("control tick", control_.tick_latency());
  add("tick, processor", control_.tick_work());
  add("image", vision_.image_latency());
  text += "ticks " + std::to_string(now.control.ticks) + ", missed " + std::to_string(now.control.missed_ticks) + ", page faults " +
          std::to_string(now.control.page_faults) + ", heap calls " + std::to_string(now.control.heap_calls) + "\n";
  text += "counted: " + counters_json(now.control, now.camera, now.telemetry).dump() + "\n";
  return text;
}

}  // namespace lf::hal
