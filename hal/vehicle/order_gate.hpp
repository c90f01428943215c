// Decides for each order, once and for all, whether the control thread takes it or the operator's side withdraws it: an operator who was told "refused"
// never sees the arm move afterwards.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace lf::hal {

class OrderGate {
 public:
  // Orders under way at once. A power of two, more than the rings between the threads hold together.
  static constexpr std::size_t capacity = 64;

  // Operator's side, before the order is handed over. Numbers go up by one and begin at 1.
  void offer(std::uint64_t number) { slot(number).store(word(number, offered), std::memory_order_release); }
  // Control thread: true when the order may be carried out.
  bool take(std::uint64_t number) { return leave(number, taken); }
  // Operator's side: true when it will never be carried out.
  bool withdraw(std::uint64_t number) { return leave(number, withdrawn); }

 private:
  enum State : std::uint64_t { offered = 1, taken = 2, withdrawn = 3 };
  static std::uint64_t word(std::uint64_t number, State state) { return number << 2U | state; }
  std::atomic<std::uint64_t>& slot(std::uint64_t number) { return slots_[number % capacity]; }
  bool leave(std::uint64_t number, State to) {
    std::uint64_t expected = word(number, offered);
    return slot(number).compare_exchange_strong(expected, word(number, to), std::memory_order_acq_rel);
  }

  std::array<std::atomic<std::uint64_t>, capacity> slots_{};
};

}  // namespace lf::hal
