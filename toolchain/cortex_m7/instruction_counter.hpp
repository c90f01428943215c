// Counts instructions by the processor's SysTick timer. Under QEMU with `-icount shift=0` an instruction takes one virtual nanosecond and a tick of the
// board's 25 MHz is 40 of them: the same count at every run. They are instructions, not the cycles of a real Cortex-M7.
#pragma once

#include <cstdint>

namespace lf::m7 {

class InstructionCounter {
 public:
  static constexpr std::uint32_t instructions_per_tick = 40;

  InstructionCounter() {
    reload() = range - 1;
    current() = 0;
    control() = 5;  // on, by the processor's clock, without its interrupt
  }
  void start() { start_ = current(); }
  // Since start(), to 40; at most 671 million.
  std::uint64_t stop() {
    const std::uint32_t ticks = (start_ - current()) & (range - 1);
    return std::uint64_t{ticks} * instructions_per_tick;
  }

 private:
  static constexpr std::uint32_t range = 1u << 24;
  static volatile std::uint32_t& reg(std::uintptr_t address) { return *reinterpret_cast<volatile std::uint32_t*>(address); }
  static volatile std::uint32_t& control() { return reg(0xE000E010); }
  static volatile std::uint32_t& reload() { return reg(0xE000E014); }
  static volatile std::uint32_t& current() { return reg(0xE000E018); }

  std::uint32_t start_ = 0;
};

}  // namespace lf::m7
