// Bad input from a user: a file, a key, an argument. One line, with the place where there is one. Hosted side only; exit status 2.
#pragma once

#include <stdexcept>
#include <string>

namespace lf {

class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  // "file:line: message"; line 0 leaves the line out.
  InputError(const std::string& file, int line, const std::string& message)
      : std::runtime_error(file + (line > 0 ? std::string(":").append(std::to_string(line)) : "") + ": " + message) {}
};

}  // namespace lf
