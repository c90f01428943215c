// Ctrl-C and SIGTERM as a flag that loops look at. The second one ends the program at once.
#pragma once

namespace lf::app {

inline constexpr int exit_interrupted = 130;  // 128 + SIGINT, as shells have it

void catch_interrupts();
bool interrupted();

}  // namespace lf::app
