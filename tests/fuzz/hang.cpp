// A target that hangs: replay.cpp has to end it.
#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t*, std::size_t) {
  volatile bool for_ever = true;
  while (for_ever) {
  }
  return 0;
}
