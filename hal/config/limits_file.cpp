#include "hal/config/limits_file.hpp"

#include <cstdio>
#include <set>

#include "hal/config/text_file.hpp"
#include "hal/config/yaml_reader.hpp"

namespace lf::config {

namespace {

constexpr double any = 1e6;

std::vector<Key> limit_keys(safety::Limits& limits, const JointNames& names, std::string& checksum) {
  std::vector<Key> all;
  for (std::size_t i = 0; i < limits.joints.size(); ++i) {
    const std::string joint = "joints." + names[i] + ".";
    all.push_back({joint + "min_rad", "", "rad", -any, any, &limits.joints[i].min_rad});
    all.push_back({joint + "max_rad", "", "rad", -any, any, &limits.joints[i].max_rad});
    all.push_back({joint + "max_speed_rad_s", "", "rad/s", 0, any, &limits.joints[i].max_speed_rad_s});
    all.push_back({joint + "max_torque_nm", "", "N m", 0, any, &limits.joints[i].max_torque_nm});
  }
  all.push_back({"workspace.min_m", "", "m", -any, any, &limits.workspace_min_m});
  all.push_back({"workspace.max_m", "", "m", -any, any, &limits.workspace_max_m});
  all.push_back({"stale_position_s", "", "s", 0, any, &limits.stale_position_s});
  all.push_back({"stale_image_s", "", "s", 0, any, &limits.stale_image_s});
  all.push_back({"vision_timeout_s", "", "s", 0, any, &limits.vision_timeout_s});
  all.push_back({"max_contact_torque_nm", "", "N m", 0, any, &limits.max_contact_torque_nm});
  all.push_back({"checksum", "", "", 0, 0, &checksum});
  return all;
}

bool has_path(const YAML::Node& node, const std::string& path) {
  const std::size_t dot = path.find('.');
  const YAML::Node next = node[path.substr(0, dot)];
  return next.IsDefined() && (dot == std::string::npos || has_path(next, path.substr(dot + 1)));
}

std::string hex(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%08x", value);
  return text;
}

}  // namespace

safety::Limits read_limits(const std::string& path, const JointNames& names) {
  const Source source = Source::of_file(path);
  const YAML::Node root = parse_yaml(read_text_file(path), source);
  if (!root.IsMap()) source.refuse(root.Mark(), "not a file of safety limits");
  safety::Limits limits;
  for (std::size_t i = 0; i < names.size(); ++i) (void)limits.joints.push_back({});  // no more than the core's arms have
  std::string checksum;
  const std::vector<Key> table = limit_keys(limits, names, checksum);
  if (const YAML::Node joints = root["joints"]; joints && joints.IsMap()) {
    for (const auto& joint : joints) {
      if (joint.first.IsScalar() && !names.find(joint.first.Scalar()) && names != JointNames())
        source.refuse(joint.first.Mark(), "'joints." + joint.first.Scalar() + "': these limits are of another arm; this one's joints are " +
                                              names.listed(names.size()));
    }
  }
  read_map(root, "", "", table, source);
  for (const Key& key : table) {
    if (!has_path(root, key.path)) source.refuse(root.Mark(), "'" + key.path + "' is missing: every limit has to be stated");
  }
  const YAML::Node stated = root["checksum"];
  char* end = nullptr;
  limits.checksum = static_cast<std::uint32_t>(std::strtoul(checksum.c_str(), &end, 16));
  if (checksum.size() != 10 || !checksum.starts_with("0x") || *end != '\0')
    source.refuse(stated.Mark(), "'checksum' takes 0x and 8 hex digits");
  const safety::LimitsVerdict verdict = safety::check(limits);
  if (verdict == safety::LimitsVerdict::wrong_checksum) {
    source.refuse(stated.Mark(), "the checksum is " + checksum + ", but these limits give " + hex(safety::limits_checksum(limits)));
  }
  if (verdict != safety::LimitsVerdict::good) source.refuse(root.Mark(), std::string("limits refused: ") + safety::name(verdict));
  return limits;
}

}  // namespace lf::config
