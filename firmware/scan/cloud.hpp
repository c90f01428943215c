// The scanned points of one sweep, in the order they came, in fixed storage.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/messages/panel_vision.hpp"

namespace lf::scan {

class Cloud {
 public:
  // A sweep of 18.1 s at 25 Hz with one frame of five for the background and 640 columns gives at most 231,680 points.
  static constexpr std::size_t capacity = 262'144;

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
