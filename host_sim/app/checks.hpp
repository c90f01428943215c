// What options take, checked as they are read: each check answers with why not, or with nothing.
//
// CLI11's own take what is not a number for one within any range, and wrap a number that is too large for its type.
#pragma once

#include <functional>
#include <string>

namespace lf::app {

// A whole number that fits 64 bits.
std::string check_seed(const std::string& text);
// A finite number above 0.
std::string check_positive(const std::string& text);
// Not empty: a shell's variable that is not set.
std::string check_filled(const std::string& text);
// A file's name without control characters.
std::string check_printable(const std::string& text);
// A folder that is there.
std::string check_folder(const std::string& text);
// A file's name that ends in .png, or has no ending.
std::string check_png(const std::string& text);
// A finite number from `low` to `high`.
std::function<std::string(const std::string&)> within(double low, double high);

}  // namespace lf::app
