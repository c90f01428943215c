#include <algorithm>
#include <optional>

#include "host_sim/record/cloud_reading.hpp"
#include "shared/input_error.hpp"

namespace lf::record {

namespace {

// Blanks, as the format has them; scanners' programs also write commas or semicolons.
std::string_view separators_of(std::string_view line) {
  if (line.find(';') != line.npos) return ";";
  if (line.find(',') != line.npos) return ",";
  return " \t";
}

// Comments: "#", and "//" with which CloudCompare names the columns.
std::string_view without_comment(std::string_view line) { return line.substr(0, std::min(line.find('#'), line.find("//"))); }

}  // namespace

CloudFile read_xyz(const std::string& name, std::string_view bytes) {
  LineReader lines(bytes);
  CloudFile cloud;
  std::optional<std::size_t> stated;  // by a first line with nothing but a number of points
  std::size_t width = 0;              // of the first point's row
  std::size_t rows = 0;
  std::string_view line;
  while (lines.next(line)) {
    line = without_comment(line);
    const auto words = words_of(line, separators_of(line));
    if (words.empty()) continue;
    std::size_t count = 0;
    if (width == 0 && !stated && words.size() == 1 && count_from_text(words[0], count)) {
      stated = count;
      continue;
    }
    if (words.size() < 3) throw InputError(name, lines.line_number(), "has fewer than three columns");
    if (width == 0) width = words.size();
    if (words.size() != width)
      throw InputError(name, lines.line_number(), "has " + std::to_string(words.size()) + " columns, not " + std::to_string(width));
    // x, y, z, and the intensity where it is the only other column: six are colours or normals.
    double values[4] = {};
    for (std::size_t i = 0; i < (width == 4 ? 4u : 3u); ++i) {
      if (!number_from_text(words[i], values[i]))
        throw InputError(name, lines.line_number(), "'" + std::string(words[i]) + "' is not a number");
    }
    ++rows;
    add_point(cloud, values[0], values[1], values[2], values[3]);
  }
  if (rows == 0) throw InputError(name, 0, "is empty");
  if (stated && *stated != rows)
    throw InputError(name, 0, "has " + std::to_string(rows) + " points, not the " + std::to_string(*stated) + " that its first line says");
  return cloud;
}

}  // namespace lf::record
