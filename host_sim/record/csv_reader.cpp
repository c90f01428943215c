#include <algorithm>
#include <vector>

#include "host_sim/record/cloud_reading.hpp"
#include "shared/input_error.hpp"

namespace lf::record {
namespace {

// The first that occurs in the line: a semicolon where commas may be decimals elsewhere, comma, else blanks.
std::string_view separators_of(std::string_view line) {
  if (line.find(';') != line.npos) return ";";
  if (line.find(',') != line.npos) return ",";
  return " \t";
}

bool all_numbers(const std::vector<std::string_view>& words) {
  return std::all_of(words.begin(), words.end(), [](std::string_view word) {
    double ignored = 0;
    return number_from_text(word, ignored);
  });
}

}  // namespace

CloudFile read_csv(const std::string& name, std::string_view bytes) {
  LineReader lines(bytes);
  CloudFile cloud;
  PointColumns columns{0, 1, 2, PointColumns::none};
  std::size_t width = 0;  // of the first row; 0 before it
  std::string_view line;
  while (lines.next(line)) {
    line = line.substr(0, line.find('#'));
    const auto words = words_of(line, separators_of(line));
    if (words.empty()) continue;
    if (width == 0) {
      width = words.size();
      if (!all_numbers(words)) {
        columns = PointColumns::from_names({words.begin(), words.end()});
        if (!columns.complete()) throw InputError(name, lines.line_number(), "is neither numbers nor a header with x, y and z");
        continue;
      }
      if (width < 3) throw InputError(name, lines.line_number(), "has fewer than three columns");
    }
    if (words.size() != width) {
      throw InputError(name, lines.line_number(), "has " + std::to_string(words.size()) + " columns, not " + std::to_string(width));
    }
    const auto value = [&](std::size_t column) {
      double number = 0;
      if (column != PointColumns::none && !number_from_text(words[column], number)) {
        throw InputError(name, lines.line_number(), "'" + std::string(words[column]) + "' is not a number");
      }
      return number;
    };
    add_point(cloud, value(columns.x), value(columns.y), value(columns.z), value(columns.intensity));
  }
  if (width == 0) throw InputError(name, 0, "is empty");
  return cloud;
}

}  // namespace lf::record
