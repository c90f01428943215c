// A vehicle's configuration: read as a whole, with the files it names, or refused with an InputError.
#include "hal/vehicle/vehicle_config.hpp"
#include "shared/input_error.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static lf::fuzz::MemoryFile file;
  try {
    const lf::hal::VehicleConfig config = lf::hal::load_vehicle_config(file.holding({data, size}));
    std::size_t offender = 0;
    const auto verdict = lf::canopen::check(config.core.controller.network, offender);
    lf::fuzz::expect(verdict == lf::canopen::ConfigError::none, "what is read, the core takes");
    lf::fuzz::expect(config.v4l2().width > 0 && config.v4l2().height > 0, "a camera has pixels");
  } catch (const lf::InputError& refused) {
    lf::fuzz::expect(refused.what()[0] != '\0', "a refusal says why");
  }
  return 0;
}
