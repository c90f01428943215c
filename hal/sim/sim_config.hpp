// The simulated platform, in one plain struct: the world, its optics, its devices, and how long its sensors take.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/sim/sim_faults.hpp"
#include "hal/vision/panel_vision.hpp"
#include "host_sim/devices/devices.hpp"
#include "host_sim/optics/optics.hpp"
#include "host_sim/world/world.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

struct SimConfig {
  world::WorldConfig world;
  optics::OpticsConfig optics;
  devices::DevicesConfig devices;
  vision::PanelVisionConfig vision;

  // From the trigger until the image can be received, if the exposure is over by then: exposure, readout and transfer of a 640x480 camera on Gigabit Ethernet.
  Duration image_latency = Duration::from_ms(30);
  // By which the shutter opens after the trigger that the core takes for the exposure's start: the camera's own delay, and the offset of the two clocks.
  Duration exposure_delay;
  // By which the time stamp of an image is late: an offset of the camera's clock.
  Duration stamp_offset;
  // From a question to panel vision until its answer can be received. The real one takes 20 to 100 ms on a desktop.
  Duration vision_latency = Duration::from_ms(300);

  // Sight is made of the truth: nothing is rendered or looked for, and the platform has no threads of its own. For runs that are not about seeing.
  bool given_sight = false;

  std::size_t valve_that_breaks = 0;  // whose handle SimFaultKind::handle_breaks takes

  // What goes wrong besides `devices.faults`.
  std::vector<SimFault> faults;
};

}  // namespace lf::hal
