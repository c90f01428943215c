// Preloaded into User Mode Linux's kernel: it runs on processors whose extended state (XSAVE) is larger than its own buffer for it.
//
// The kernel keeps 2696 bytes of registers of each program of the guest (up to AVX-512 and PKRU) and writes them back by PTRACE_SETREGSET. The machine's
// kernel takes a whole state only, EFAULT otherwise (arch/x86/kernel/fpu/regset.c), and with AMX a whole state has 11008 bytes: without this the guest ends
// at its first program. What does not fit is put back into its initial state, so the guest's programs have no AMX.
#include <cpuid.h>
#include <dlfcn.h>
#include <elf.h>
#include <sys/ptrace.h>
#include <sys/uio.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstring>

namespace {

using Ptrace = long (*)(__ptrace_request, ...);
Ptrace machines_ptrace() {
  static const auto found = reinterpret_cast<Ptrace>(dlsym(RTLD_NEXT, "ptrace"));
  return found;
}

// The components of the state that end within `bytes` (CPUID leaf 13); 0 and 1, x87 and SSE, are in the first 512 bytes.
std::uint64_t components_within(std::size_t bytes) {
  std::uint64_t components = 3;
  for (unsigned one = 2; one < 63; ++one) {
    unsigned size = 0, offset = 0, flags = 0, unused = 0;
    __cpuid_count(13, one, size, offset, flags, unused);
    if (size > 0 && offset + size <= bytes) components |= std::uint64_t{1} << one;
  }
  return components;
}

// errno is that of the last call to the kernel. One thread of User Mode Linux traces, so one buffer is enough; its stacks are small.
long set_part_of_state(long pid, const iovec& part) {
  constexpr std::size_t header = 512;  // its first 8 bytes say which components are not in their initial state
  alignas(64) static char state[1 << 16];
  iovec whole{state, sizeof state};
  if (const long status = machines_ptrace()(PTRACE_GETREGSET, pid, NT_X86_XSTATE, &whole); status != 0) return status;
  std::memcpy(state, part.iov_base, std::min(part.iov_len, whole.iov_len));
  static const std::uint64_t kept = components_within(part.iov_len);
  std::uint64_t in_use = 0;
  std::memcpy(&in_use, state + header, sizeof in_use);
  in_use &= kept;
  std::memcpy(state + header, &in_use, sizeof in_use);
  return machines_ptrace()(PTRACE_SETREGSET, pid, NT_X86_XSTATE, &whole);
}

}  // namespace

extern "C" long ptrace(__ptrace_request request, ...) noexcept {
  va_list rest;
  va_start(rest, request);
  const long pid = va_arg(rest, int);
  void* const address = va_arg(rest, void*);
  void* const data = va_arg(rest, void*);
  va_end(rest);
  const long status = machines_ptrace()(request, pid, address, data);
  const bool too_short =
      status != 0 && errno == EFAULT && request == PTRACE_SETREGSET && reinterpret_cast<std::uintptr_t>(address) == NT_X86_XSTATE;
  return too_short ? set_part_of_state(pid, *static_cast<const iovec*>(data)) : status;
}
