// An emergency-stop input of the vehicle's computer: a file that reads "1" while the chain is closed, as a GPIO's value does in sysfs. A cut wire, a file
// that is gone, unreadable or says anything else ("12", "1 V") is a stop. The chain at the output node is another input, and the core's own affair.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <utility>

#include "shared/messages/time.hpp"

namespace lf::hal {

// What the file says: "1" or "0", with one newline or without; anything else, and a file that cannot be read, is neither.
enum class EstopReading : std::uint8_t { closed, open, neither };
EstopReading read_estop(const std::string& path);

class EstopInput {
 public:
  EstopInput() = default;  // none: closed
  explicit EstopInput(std::string path) : path_(std::move(path)) {}
  bool present() const { return !path_.empty(); }
  // Reads the file anew.
  bool closed() const;

 private:
  std::string path_;
};

// Carries what the input says from the thread that reads it to the control thread. An input that nobody has read for 300 ms counts as open: the thread
// that reads it hangs.
class EstopLine {
 public:
  static constexpr Duration believed_for = Duration::from_ms(300);

  // `present` false: there is no input, the line is always closed.
  explicit EstopLine(bool present) : present_(present) {}
  void tell(bool closed, Time now) { closed_ns_.store(closed ? now.ns() : never, std::memory_order_release); }
  bool closed(Time now) const {
    const std::int64_t last = closed_ns_.load(std::memory_order_acquire);
    return !present_ || (last != never && now.ns() - last <= believed_for.ns());
  }

 private:
  static constexpr std::int64_t never = -1;
  const bool present_;
  std::atomic<std::int64_t> closed_ns_{never};
};

}  // namespace lf::hal
