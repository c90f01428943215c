// An emergency-stop input of the vehicle's computer: a file that reads "1" while the chain is whole, as a GPIO's value does in sysfs. A cut wire, a file
// that is gone, unreadable or says anything else is a stop. The chain at the output node is another input, and the core's own affair.
#pragma once

#include <string>

namespace lf::hal {

class EstopInput {
 public:
  EstopInput() = default;  // none: whole
  explicit EstopInput(std::string path) : path_(std::move(path)) {}
  bool present() const { return !path_.empty(); }
  // Reads the file anew.
  bool whole() const;

 private:
  std::string path_;
};

}  // namespace lf::hal
