// Counts the heap calls that are made inside the core.
//
// A program that links lf_heap_guard has the C library's allocation functions replaced by ones that forward and, on a thread inside a
// CoreSection, count. Sanitizers bring allocators of their own: built with one, nothing is replaced and `available()` is false.
#pragma once

#include <cstdint>

namespace lf::hal {

class CoreSection {
 public:
  CoreSection();
  ~CoreSection();
  CoreSection(const CoreSection&) = delete;
  CoreSection& operator=(const CoreSection&) = delete;
};

struct HeapGuard {
  static bool available();
  static std::uint64_t calls();  // by all threads inside core sections, since the program's start
};

}  // namespace lf::hal
