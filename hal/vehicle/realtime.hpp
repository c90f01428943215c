// What a thread and its process can be given for real time, and what of it this machine grants.
#pragma once

#include <string>
#include <vector>

namespace lf::hal {

struct RealtimeConfig {
  int priority = 80;        // SCHED_FIFO; above the kernel's threaded interrupts at 50, below its watchdogs at 99. 0: not asked for
  int cpu = -1;             // that the control thread is tied to; -1: any
  bool lock_memory = true;  // mlockall: nothing is paged out, nothing is paged in late
};

// Of the process, before it starts threads: locks its memory, keeps freed memory, and lets threads have stacks of 2 MB, since what is locked is all
// there. Each returns a sentence, with the remedy, for everything that the kernel refused it; no sentence where it refused nothing.
std::vector<std::string> lock_process_memory(const RealtimeConfig& config);
// Of the calling thread.
std::vector<std::string> become_realtime(const RealtimeConfig& config);
// Touches 256 KB of the calling thread's stack, so that they are there.
void prefault_stack();
// Of the calling thread since its start.
long page_faults();

void name_thread(const char* name);  // at most 15 letters

}  // namespace lf::hal
