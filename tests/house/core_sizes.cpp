// Prints what the core takes of memory; run by the build, so that growth is seen when it happens.
#include <cstdio>

#include "firmware/controller.hpp"
#include "firmware/scan_pipeline.hpp"

// A small core's control side fits the tightly coupled memory of a Cortex-M7 with 64 KiB of it, and leaves 24 for stacks (tests/target/m7); the vision side has its own
// budget.
constexpr std::size_t budget = 64 * 1024;
static_assert(sizeof(lf::Controller) <= budget, "budget of the control thread");

int main() {
  std::printf("sizeof(Controller) = %zu of %zu bytes, sizeof(ScanPipeline) = %zu bytes\n", sizeof(lf::Controller), budget,
              sizeof(lf::ScanPipeline));
}
