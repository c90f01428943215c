// The scanned points of one sweep, in the order they came, in fixed storage.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/messages/panel_vision.hpp"

namespace lf::scan {

template <std::size_t Capacity>
class BasicCloud {
 public:
  static constexpr std::size_t capacity = Capacity;

  // False when full: the caller counts what it lost.
  [[nodiscard]] bool add(const CloudPoint& point) {
    if (size_ == capacity) return false;
    points_[size_++] = point;
    return true;
  }
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  std::span<const CloudPoint> points() const { return {points_.data(), size_}; }

 private:
  std::array<CloudPoint, capacity> points_;
  std::size_t size_ = 0;
};

}  // namespace lf::scan
