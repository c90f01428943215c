// The calling thread before all that is not real-time, where that is allowed; threads that it starts later come along, others do not.
//
// Not SCHED_FIFO: catching up after a delay, it would keep a single processor from the very master that waits for its answers.
#pragma once

#include <sys/resource.h>

namespace lf::serve {

inline void come_first() { (void)setpriority(PRIO_PROCESS, 0, -20); }

}  // namespace lf::serve
