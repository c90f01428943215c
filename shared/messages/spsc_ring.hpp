// The join between two threads: a ring with one producer and one consumer, wait-free on both sides.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace lf {

// `Capacity` is a power of two. A push into a full ring is refused and counted; nothing blocks.
template <class T, std::size_t Capacity>
class SpscRing {
  static_assert((Capacity & (Capacity - 1)) == 0, "capacity is a power of two");

 public:
  // Producer's side.
  bool push(const T& value) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == Capacity) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    items_[head & (Capacity - 1)] = value;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  // Consumer's side. False when empty.
  bool pop(T& value) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = items_[tail & (Capacity - 1)];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  // Elements refused because the ring was full.
  std::uint32_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  std::array<T, Capacity> items_{};
  alignas(64) std::atomic<std::size_t> head_{0};  // a cache line each: the two threads do not share one
  alignas(64) std::atomic<std::size_t> tail_{0};
  std::atomic<std::uint32_t> lost_{0};
};

}  // namespace lf
