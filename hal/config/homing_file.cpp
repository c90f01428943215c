#include "hal/config/homing_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>

#include "hal/config/text_file.hpp"
#include "hal/config/yaml_reader.hpp"
#include "shared/input_error.hpp"

namespace lf::config {

const char* joint_name(std::size_t joint) {
  constexpr std::array<const char*, joint_count> names{"slew", "shoulder", "elbow", "roll", "jaw"};
  return joint < names.size() ? names[joint] : "?";
}

HomingOffsets read_homing_file(const std::string& path) {
  const Source source = Source::of_file(path);
  const YAML::Node root = parse_yaml(read_text_file(path), source);
  if (!root.IsMap()) source.refuse(root.Mark(), "not a file of homing offsets");
  HomingOffsets offsets;
  Keys table;
  constexpr double low = std::numeric_limits<std::int32_t>::min() / 2.0, high = std::numeric_limits<std::int32_t>::max() / 2.0;
  for (std::size_t i = 0; i < joint_count; ++i) {
    const std::string joint = std::string(joint_name(i));
    table.push_back(key(joint + ".zero_counts", "counts", low, high, &offsets.zero_counts[i], ""));
    table.push_back(key(joint + ".found", "", 0, 0, &offsets.found[i], ""));
  }
  read_map(root, "", "", table, source);
  for (std::size_t i = 0; i < joint_count; ++i) {
    if (!root[joint_name(i)] || !root[joint_name(i)]["zero_counts"])
      source.refuse(root.Mark(), std::string("'") + joint_name(i) + ".zero_counts' is missing: commission this joint");
  }
  return offsets;
}

void write_homing_file(const std::string& path, const HomingOffsets& offsets) {
  const std::string partial = path + ".partial";
  std::ofstream out(partial);
  out << "# Written by `lanternfishd commission`: what each drive's absolute encoder counts where the arm's own count is 0.\n";
  for (std::size_t i = 0; i < joint_count; ++i)
    out << joint_name(i) << ": {zero_counts: " << offsets.zero_counts[i] << ", found: \"" << offsets.found[i] << "\"}\n";
  out.close();
  if (!out || std::rename(partial.c_str(), path.c_str()) != 0) throw InputError(path + ": cannot be written: " + std::strerror(errno));
}

}  // namespace lf::config
