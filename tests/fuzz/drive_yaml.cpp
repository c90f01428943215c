// The profile of a make of drive: read and applied to a motor, or refused with an InputError. What is applied, the core's own check takes.
#include "hal/config/drive_kind.hpp"
#include "shared/input_error.hpp"
#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static lf::fuzz::MemoryFile file;
  try {
    const lf::config::DriveKind kind = lf::config::read_drive_kind(file.holding({data, size}));
    (void)kind.error_text(0x8611);
    lf::canopen::DriveSetup setup;
    lf::config::apply(kind, {64, 3.3, 1.333, false}, "fuzz", setup);
  } catch (const lf::InputError& refused) {
    lf::fuzz::expect(refused.what()[0] != '\0', "a refusal says why");
  }
  return 0;
}
