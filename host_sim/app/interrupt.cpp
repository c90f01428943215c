#include "host_sim/app/interrupt.hpp"

#include <csignal>

namespace lf::app {

namespace {

volatile std::sig_atomic_t flag = 0;

extern "C" void on_interrupt(int) { flag = 1; }

}  // namespace

// Without SA_RESTART: an interrupt wakes a campaign that waits for its runs. Once only: the second one ends the program.
void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return flag != 0; }

}  // namespace lf::app
