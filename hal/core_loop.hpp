// One turn of the control thread and one of the vision thread, the same code on every platform: here bytes move between the ports and the core.
//
// On the vehicle each runs on its own thread and the rings between them are crossed; in lockstep they take turns on one.
#pragma once

#include <cstdint>
#include <span>

#include "firmware/controller.hpp"
#include "firmware/scan_pipeline.hpp"
#include "hal/heap_guard/heap_guard.hpp"
#include "hal/ports.hpp"
#include "shared/messages/spsc_ring.hpp"

namespace lf::hal {

// The joins between control and vision thread. Sizes: 250 joint samples a second against a vision turn of at most 100 ms, with room for a stall.
struct CoreRings {
  SpscRing<ScanCommand, 1024> scan_commands;  // control -> vision
  SpscRing<ScanStats, 16> scan_stats;         // vision -> control, after every image
  Time next_estop;                            // the control thread's own: when an open emergency-stop input is told to the core again
};

// While the platform's emergency-stop input stays open the core is told ten times a second: it forgets an order with its reset.
inline constexpr Duration estop_repeat = Duration::from_ms(100);

// Called around the core's work in each turn, for timing; the default does nothing.
struct NoProbe {
  void begin() {}
  void end() {}
};

// Frames taken from a bus in one tick. Six nodes answer with at most 3 frames each (TPDO, heartbeat, SDO); four ticks' worth covers a late tick.
inline constexpr int max_frames_a_tick = 72;

// Hands over what operators ordered. True when the end of the program was among it.
template <Platform P>
bool take_orders(P& platform, Controller& controller, CoreRings& rings, Time now) {
  bool estop_closed = false;
  if (platform.read_estop(estop_closed) != port_ok) estop_closed = false;
  if (estop_closed) {
    rings.next_estop = now;
  } else if (now >= rings.next_estop) {
    rings.next_estop = now + estop_repeat;
    (void)controller.on_command(Command::emergency_stop, now);
  }
  bool shut_down = false;
  for (NumberedOrder order; platform.receive_order(order) == port_ok;) {
    OrderAnswer answer;
    answer.number = order.number;
    answer.standing = controller.mission().standing();
    answer.taken = controller.on_order(order.order, now);
    shut_down = shut_down || order.order.command == Command::shut_down;
    (void)platform.answer_order(answer);  // an operator who does not hear of it asks for the status
  }
  return shut_down;
}

// One control period. True when the end of the program was ordered in it.
template <Platform P, class Probe>
bool control_turn(P& platform, Controller& controller, CoreRings& rings, TickOutput& out, Time& now, Probe& probe) {
  Time tick = now;
  const PortStatus clock = platform.wait_for_tick(tick);
  // Without a clock the last time plus a period keeps the core's watchdogs running; the fault is the core's to judge.
  now = clock == port_ok ? tick : now + can_map::sync_period;

  probe.begin();
  out.clear();
  if (clock != port_ok) controller.on_port_error(Port::clock, clock, now);
  bool shut_down = false;
  {
    CoreSection core;
    shut_down = take_orders(platform, controller, rings, now);
  }
  for (std::uint8_t bus = 0; bus < bus_count; ++bus) {
    for (int i = 0; i < max_frames_a_tick; ++i) {
      ReceivedFrame received;
      const PortStatus status = platform.receive_can(bus, received);
      if (status == port_empty) break;
      CoreSection core;
      if (status == port_ok) {
        controller.on_can(bus, received.frame, received.t);
      } else {
        controller.on_port_error(Port::can_receive, status, now);
        break;
      }
    }
  }
  PanelResult panel;
  if (const PortStatus status = platform.receive_panel(panel); status == port_ok) {
    CoreSection core;
    controller.on_panel(panel, now);
  } else if (status != port_empty) {
    controller.on_port_error(Port::panel_receive, status, now);
  }
  {
    CoreSection core;
    for (ScanStats stats; rings.scan_stats.pop(stats);) controller.on_scan(stats, now);
    controller.tick(now, out);
    for (const ScanCommand& command : out.scan) {
      if (!rings.scan_commands.push(command)) controller.on_port_error(Port::scan_ring, 1, now);
    }
  }
  probe.end();

  for (std::uint8_t bus = 0; bus < bus_count; ++bus) {
    const std::span<const CanFrame> frames(out.can[bus].data(), out.can[bus].size());
    if (frames.empty()) continue;
    if (const PortStatus status = platform.send_can(bus, frames); status != port_ok) controller.on_port_error(Port::can_send, status, now);
  }
  if (const PortStatus status = platform.publish(out.telemetry); status != port_ok) {
    controller.on_port_error(Port::telemetry, status, now);
  }
  return shut_down;
}

// `report_error(port, code)` tells the control side of a failed call; on the vehicle it crosses a ring.
template <Platform P, class Pipeline, class Probe, class ReportError>
void vision_turn(P& platform, Pipeline& pipeline, CoreRings& rings, Probe& probe, ReportError report_error) {
  {
    CoreSection core;
    for (ScanCommand command; rings.scan_commands.pop(command);) pipeline.on_command(command);
  }
  for (std::uint8_t camera = 0; camera < camera_count; ++camera) {
    Image image;
    const PortStatus status = platform.receive_image(camera, image);
    if (status == port_empty) continue;
    if (status != port_ok) {
      report_error(Port::camera, status);
      continue;
    }
    probe.begin();
    {
      CoreSection core;
      pipeline.on_image(camera, image);
      rings.scan_stats.push(pipeline.stats());
    }
    probe.end();
  }
  PanelRequest request;
  bool asked = false;
  {
    CoreSection core;
    asked = pipeline.take_request(request);
    if (asked) rings.scan_stats.push(pipeline.stats());
  }
  if (asked) {
    if (const PortStatus status = platform.submit_panel(request, pipeline.still(), pipeline.cloud()); status != port_ok) {
      report_error(Port::panel_submit, status);
    }
  }
}

}  // namespace lf::hal
