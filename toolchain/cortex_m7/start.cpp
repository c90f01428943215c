// From reset to main() on a bare Cortex-M7, and what ends a program that goes wrong.
#include <cstddef>
#include <cstdint>

#include "toolchain/cortex_m7/semihosting.hpp"
#include "toolchain/cortex_m7/stack_use.hpp"

extern "C" {

// Places that the linker script names.
extern std::uint32_t data_begin[], data_end[], data_image[], bss_begin[], bss_end[], psram_begin[], psram_end[], stack_begin[], stack_end[];
extern void (*init_array_begin[])();
extern void (*init_array_end[])();

int lf_main() asm("main");
[[noreturn]] void lf_reset();
void lf_fault();
[[noreturn]] void lf_report_fault();
}

namespace {

constexpr std::uint32_t stack_paint = 0xA5A5A5A5u;

volatile std::uint32_t& reg(std::uintptr_t address) { return *reinterpret_cast<volatile std::uint32_t*>(address); }

void fill(std::uint32_t* begin, const std::uint32_t* end, std::uint32_t value) {
  for (volatile std::uint32_t* word = begin; word != end; ++word) *word = value;
}

}  // namespace

// Armv7-M: initial stack pointer, reset, NMI, hard fault, memory management, bus and usage fault, four reserved, SVCall, debug, reserved, PendSV,
// SysTick. No interrupt is used.
using Vector = void (*)();
[[gnu::section(".vectors"), gnu::used]] const Vector vectors[16] = {reinterpret_cast<Vector>(stack_end),
                                                                    lf_reset,
                                                                    lf_fault,
                                                                    lf_fault,
                                                                    lf_fault,
                                                                    lf_fault,
                                                                    lf_fault,
                                                                    nullptr,
                                                                    nullptr,
                                                                    nullptr,
                                                                    nullptr,
                                                                    lf_fault,
                                                                    lf_fault,
                                                                    nullptr,
                                                                    lf_fault,
                                                                    lf_fault};

void lf_reset() {
  reg(0xE000ED88) = reg(0xE000ED88) | (0xFu << 20);  // CPACR: coprocessors 10 and 11, the floating-point unit
  reg(0xE000ED14) = reg(0xE000ED14) | (1u << 4);     // CCR.DIV_0_TRP: an integer division by zero is a fault
  asm volatile("dsb\n isb" ::: "memory");
  // Down from here the stack is not used yet.
  std::uint32_t* here;
  asm volatile("mov %0, sp" : "=r"(here));
  fill(stack_begin, here - 16, stack_paint);
  for (std::ptrdiff_t i = 0; i < data_end - data_begin; ++i) data_begin[i] = data_image[i];
  fill(bss_begin, bss_end, 0);
  fill(psram_begin, psram_end, 0);
  for (void (**constructor)() = init_array_begin; constructor != init_array_end; ++constructor) (*constructor)();
  lf::m7::exit(lf_main());
}

// The stack may be what is wrong: the report begins a new one.
[[gnu::naked]] void lf_fault() { asm volatile("ldr sp, =stack_end\n b lf_report_fault"); }

void lf_report_fault() {
  lf::m7::print("processor fault: CFSR ");
  lf::m7::print_hex(reg(0xE000ED28));
  lf::m7::print(" HFSR ");
  lf::m7::print_hex(reg(0xE000ED2C));
  lf::m7::print("\n");
  lf::m7::exit(3);
}

std::size_t lf::m7::stack_used_bytes() {
  const std::uint32_t* lowest = stack_begin;
  while (lowest != stack_end && *lowest == stack_paint) ++lowest;
  return static_cast<std::size_t>(stack_end - lowest) * sizeof(std::uint32_t);
}

std::size_t lf::m7::stack_bytes() { return static_cast<std::size_t>(stack_end - stack_begin) * sizeof(std::uint32_t); }

// What the compiler and the C library ask for beside the core: loops that become calls, and a pure virtual function called too early.
extern "C" void __cxa_pure_virtual() { lf::m7::fail("a pure virtual function was called"); }
extern "C" void __aeabi_atexit() {}
