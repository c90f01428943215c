// Prints what the core takes of memory; run by the build, so that growth is seen when it happens.
#include <cstdio>

#include "firmware/controller.hpp"
#include "firmware/scan_pipeline.hpp"

// The control side fits the tightly coupled memory of a Cortex-M7 with 64 KiB of it, and leaves 24 for stacks; the vision side has its own budget.
static_assert(sizeof(lf::Controller) <= 40 * 1024, "budget of the control thread");

int main() {
  std::printf("sizeof(Controller) = %zu of 40960 bytes, sizeof(ScanPipeline) = %zu bytes\n", sizeof(lf::Controller),
              sizeof(lf::ScanPipeline));
}
