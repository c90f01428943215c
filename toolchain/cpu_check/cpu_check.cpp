// Ends a program with a message when the processor lacks what the rest of it is compiled for, before any of that runs.
//
// This file alone is compiled for the plain x86-64. It calls nothing of C++: a shared inline function may have been compiled elsewhere, with AVX2.
// LANTERNFISH_PROGRAM is the program's name (lanternfish_check_cpu in toolchain/lanternfish_targets.cmake).
#include <unistd.h>

#if defined(__x86_64__)
namespace {

constexpr char message[] = LANTERNFISH_PROGRAM
    ": this processor has no AVX2 and FMA, which this build needs; build again with -DLANTERNFISH_MARCH=x86-64 (slower)\n";

// 101 is the earliest priority open to programs: before every constructor of a static object.
__attribute__((constructor(101))) void require_avx2() {
  __builtin_cpu_init();
#if defined(LANTERNFISH_NEEDS_AVX2)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return;
  if (write(STDERR_FILENO, message, sizeof message - 1) < 0) _exit(3);
  _exit(3);
#else
  (void)message;
#endif
}

}  // namespace
#endif
