// Lines, words and numbers of a mesh's file. Inside this folder only.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "shared/geometry/pose.hpp"

namespace lf::mesh {

// "'text'" with what would break a line replaced, and cut when it is long.
std::string shown(std::string_view text);
// Six digits: "0.125". "(0, 1, 0.125)".
std::string shown(double value);
std::string shown(const Vec3& place);
// "1 edge", "2 edges".
std::string counted(std::size_t count, std::string_view noun);

std::string lower_case(std::string_view text);  // ASCII, whatever the locale

class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  // False behind the last line.
  bool next();
  std::string_view line() const { return line_; }  // without its line feed
  int number() const { return number_; }           // from 1
  bool is_cut() const { return is_cut_; }          // the line has no line feed: it is the last, and may not be whole
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_, line_;
  int number_ = 0;
  bool is_cut_ = false;
};

class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}
  // "" behind the last word.
  std::string_view next();

 private:
  std::string_view rest_;
};

// The whole word, with a decimal point whatever the locale; may be infinite or not a number. A leading plus is allowed.
std::optional<double> number(std::string_view word);
std::optional<std::int64_t> integer(std::string_view word);

// Far more than a model has, and its third power is still a number.
inline constexpr double most_coordinate = 1e12;
bool is_coordinate(double value);
// Of text. Throws InputError; `noun` begins its message: "a vertex".
double coordinate(std::string_view word, std::string_view noun, const std::string& file, int line);

// Throws InputError when a text holds a byte 0.
void refuse_zero_bytes(std::string_view text, const std::string& file);

}  // namespace lf::mesh
