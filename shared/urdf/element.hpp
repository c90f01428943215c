// One element of a URDF under reading, and the report of what is wrong in the file. Inside this folder only.
#pragma once

#include <tinyxml2.h>

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/urdf/read_urdf.hpp"

namespace lf::urdf {

// "'text'" with what would break a line replaced, and cut when it is long.
std::string shown(std::string_view text);
// "a, b and c".
std::string listed(std::span<const std::string_view> words);

// What is told of one file.
class Report {
 public:
  explicit Report(std::string file) : file_(std::move(file)) {}

  void problem(int line, const std::string& text);
  void note(int line, const std::string& text);  // too many are a problem
  const std::string& file() const { return file_; }
  std::size_t problems() const { return found_; }
  // Throws InputError with all problems, when there are any.
  void refuse() const;
  std::vector<Note> notes() const;

 private:
  std::string file_;
  std::size_t found_ = 0;
  std::vector<Note> problems_, notes_;
};

// What an element may hold. Anything else is refused, but for what has a foreign prefix, which is told.
struct Table {
  std::vector<std::string_view> attributes = {};
  std::vector<std::string_view> once = {};               // children that may come once; a second <origin> is told, any other is refused
  std::vector<std::string_view> many = {};               // children that may come any number of times
  std::vector<std::string_view> unused = {};             // children that are valid and of no use here
  std::vector<std::string_view> ours = {};               // children of the prefix lanternfish
  std::vector<std::string_view> unused_attributes = {};  // attributes that are valid and of no use here
};

// Where a number has to be.
struct Bounds {
  double lowest;
  double highest;
  const char* remedy;  // ends the message
};
inline constexpr double most_length_m = 1000, most_angle_rad = 1000;
inline constexpr Bounds any_number{-1e15, 1e15, "correct it"};
inline constexpr Bounds a_length{-most_length_m, most_length_m, "URDF has metres; is it in millimetres?"};
inline constexpr Bounds an_extent{1e-9, most_length_m, "URDF has metres, above 0"};
inline constexpr Bounds an_angle{-most_angle_rad, most_angle_rad, "URDF has radians"};
inline constexpr Bounds not_negative{0, 1e15, "it must not be negative"};

class Element {
 public:
  Element(const tinyxml2::XMLElement* at, Report& report) : at_(at), report_(&report) {}

  std::string_view name() const { return at_->Name(); }
  int line() const { return at_->GetLineNum(); }
  // "joint 'elbow'", or "<limit> of joint 'elbow'" for what has no name of its own.
  std::string label() const;
  // Prefixed with the label.
  void problem(const std::string& text) const { report_->problem(line(), label() + " " + text); }
  void note(const std::string& text) const { report_->note(line(), label() + " " + text); }
  Report& report() const { return *report_; }

  // Compares what is there with what may be.
  void check(const Table& table) const;

  std::optional<Element> child(const char* name) const;
  std::vector<Element> children(const char* name) const;
  std::vector<Element> children() const;
  // The same; a problem with the remedy when there is none.
  std::optional<Element> needed_child(const char* name, const char* remedy) const;

  bool has(const char* attribute) const { return at_->Attribute(attribute) != nullptr; }
  // "" when there is none.
  std::string_view text(const char* attribute) const;
  // The same, and a problem when there is none, or it is empty.
  std::string_view needed_text(const char* attribute, const char* remedy) const;
  // A name: not empty, of printable characters, without white space at its ends, at most 256 bytes. "" after a problem.
  std::string needed_name(const char* attribute = "name") const;

  // As many numbers as `values` takes, with white space between. False after a problem, and then `values` is as it was. Refuses what is missing.
  bool numbers(const char* attribute, std::span<double> values, const Bounds& bounds) const;
  // The same of one; `missing` when there is no such attribute, and after a problem.
  double number(const char* attribute, double missing, const Bounds& bounds) const;
  // The same of one that has to be there; nothing after a problem.
  std::optional<double> needed_number(const char* attribute, const Bounds& bounds) const;

  // The pose of the child <origin>; identity when there is none.
  Pose origin() const;
  // The children of the prefix lanternfish, with their keys checked.
  std::vector<Extension> extensions() const;

  const tinyxml2::XMLElement* xml() const { return at_; }

 private:
  void check_attributes(const Table& table) const;
  void check_children(const Table& table) const;
  void check_text() const;

  const tinyxml2::XMLElement* at_;
  Report* report_;
};

}  // namespace lf::urdf
