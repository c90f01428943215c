#include "hal/vehicle/end_signals.hpp"

#include <pthread.h>
#include <sys/signalfd.h>

#include <csignal>

namespace lf::hal {

int take_end_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGHUP);  // the terminal is gone: the arm is not left to itself
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  return signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
}

}  // namespace lf::hal
