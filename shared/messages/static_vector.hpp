// A vector with its storage inside: the core's only growing container.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>

namespace lf {

// Holds up to `Capacity` elements in place. A push beyond it changes nothing and says so; nothing throws or allocates.
// T is default-constructible and copyable: removed elements are only forgotten.
template <class T, std::size_t Capacity>
class StaticVector {
 public:
  StaticVector() = default;
  // Of these elements, no more than the capacity.
  template <std::same_as<T>... More>
  requires(sizeof...(More) < Capacity) explicit StaticVector(const T& first, const More&... more)
      : items_{first, more...}, size_(1 + sizeof...(More)) {}

  static constexpr std::size_t capacity() { return Capacity; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == Capacity; }

  // False when full: the caller counts what it lost.
  [[nodiscard]] bool push_back(const T& value) {
    if (full()) return false;
    items_[size_++] = value;
    return true;
  }
  // One more element, holding what was last in its place; for elements too big to pass through the stack. Null when full.
  [[nodiscard]] T* extend() { return full() ? nullptr : &items_[size_++]; }
  void pop_back() {
    if (size_ > 0) --size_;
  }
  void clear() { size_ = 0; }

  T& operator[](std::size_t i) { return items_[i]; }
  const T& operator[](std::size_t i) const { return items_[i]; }
  T& back() { return items_[size_ - 1]; }
  const T& back() const { return items_[size_ - 1]; }
  friend bool operator==(const StaticVector& a, const StaticVector& b) requires std::equality_comparable<T> {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }
  T* data() { return items_.data(); }
  const T* data() const { return items_.data(); }
  T* begin() { return items_.data(); }
  T* end() { return items_.data() + size_; }
  const T* begin() const { return items_.data(); }
  const T* end() const { return items_.data() + size_; }

 private:
  std::array<T, Capacity> items_{};
  std::size_t size_ = 0;
};

}  // namespace lf
