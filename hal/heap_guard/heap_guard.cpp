#include "hal/heap_guard/heap_guard.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LANTERNFISH_HEAP_GUARD 0
#else
#define LANTERNFISH_HEAP_GUARD 1
#endif

namespace {

// Initial-exec: reading it never allocates, not even on a thread's first call.
__attribute__((tls_model("initial-exec"))) thread_local int core_depth = 0;
std::atomic<std::uint64_t> calls_inside{0};

#if LANTERNFISH_HEAP_GUARD
void count_call() {
  if (core_depth > 0) calls_inside.fetch_add(1, std::memory_order_relaxed);
}
#endif

}  // namespace

#if LANTERNFISH_HEAP_GUARD
// glibc's own names of its allocator: the replacements below forward to them.
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier): they are glibc's
void* __libc_malloc(std::size_t);
void __libc_free(void*);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
// NOLINTEND(bugprone-reserved-identifier)

void* malloc(std::size_t size) {
  count_call();
  return __libc_malloc(size);
}
void free(void* p) {
  if (p != nullptr) count_call();
  __libc_free(p);
}
void* calloc(std::size_t count, std::size_t size) {
  count_call();
  return __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) {
  count_call();
  return __libc_realloc(p, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count_call();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count_call();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) {
  count_call();
  *p = __libc_memalign(alignment, size);
  return *p == nullptr ? ENOMEM : 0;
}
}
#endif

namespace lf::hal {

CoreSection::CoreSection() { ++core_depth; }
CoreSection::~CoreSection() { --core_depth; }

bool HeapGuard::available() { return LANTERNFISH_HEAP_GUARD != 0; }
std::uint64_t HeapGuard::calls() { return calls_inside.load(std::memory_order_relaxed); }

}  // namespace lf::hal
