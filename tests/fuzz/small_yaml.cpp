// The small files: limits, homing offsets, a camera's calibration. Each reader gets every input, and takes it or refuses it with an InputError.
#include <cmath>

#include "hal/config/homing_file.hpp"
#include "hal/config/limits_file.hpp"
#include "hal/vision/calibration_file.hpp"
#include "shared/input_error.hpp"
#include "tests/fuzz/input.hpp"

namespace {

template <class Read>
void refused_or(const Read& read) {
  try {
    read();
  } catch (const lf::InputError& refused) {
    lf::fuzz::expect(refused.what()[0] != '\0', "a refusal says why");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static lf::fuzz::MemoryFile file;
  const std::string path = file.holding({data, size});
  refused_or([&] {
    lf::fuzz::expect(lf::safety::check(lf::config::read_limits(path, {})) == lf::safety::LimitsVerdict::good, "limits are good");
  });
  refused_or([&] { (void)lf::config::read_homing_file(path, {}); });
  refused_or([&] {
    const lf::CameraIntrinsics camera = lf::vision::read_camera_calibration(path);
    lf::fuzz::expect(camera.fx > 0 && camera.fy > 0 && std::isfinite(camera.cx + camera.cy), "a camera's figures are numbers");
  });
  return 0;
}
