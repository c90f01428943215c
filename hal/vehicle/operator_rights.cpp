#include "hal/vehicle/operator_rights.hpp"

#include <grp.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>

namespace lf::hal {

const char* name(Role role) {
  constexpr std::array<const char*, role_count> names{"watcher", "operator", "engineer"};
  const auto i = static_cast<std::size_t>(role);
  return i < names.size() ? names[i] : "nobody";
}

const std::vector<Right>& operator_rights() {
  static const std::vector<Right> rights{
      {"status", Role::watcher, "how things stand", R"({"do": "status"})"},
      {"estop", Role::watcher, "emergency stop: whoever sees the need may press it", R"({"do": "estop"})"},
      {"start", Role::pilot, "the job, from power-on if need be", R"({"do": "start"})"},
      {"home", Role::pilot, "power up, boot, home, and wait", R"({"do": "home"})"},
      {"hold", Role::pilot, "halt the arm on its way", R"({"do": "hold"})"},
      {"resume", Role::pilot, "go on from there", R"({"do": "resume"})"},
      {"abort", Role::pilot, "let go, go back, stow", R"({"do": "abort"})"},
      {"task", Role::pilot, "another job",
       R"({"do": "task", "tasks": [{"turn_valve": {"to_deg": 45}}, {"press_buttons": {"order": ["left", "centre"]}}]})"},
      {"reset", Role::pilot, "forget how the last mission ended", R"({"do": "reset"})"},
      {"jog", Role::engineer, "one joint by a small angle", R"({"do": "jog", "joint": "elbow", "by_deg": -5})"},
      {"commission", Role::engineer, "find and store the zeros of the joints' absolute encoders",
       R"({"do": "commission", "joints": ["elbow"], "clear": true})"},
      {"restart-bus", Role::engineer, "bring a CAN controller back that went bus-off", R"({"do": "restart-bus"})"},
  };
  return rights;
}

const Right* right_of(std::string_view request) {
  const std::vector<Right>& all = operator_rights();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Right& right) { return request == right.request; });
  return found == all.end() ? nullptr : &*found;
}

namespace {

std::vector<std::string> names_of(unsigned user) {
  std::vector<std::string> names;
  const passwd* entry = getpwuid(user);
  if (entry == nullptr) return names;
  names.emplace_back(entry->pw_name);
  int count = 64;
  std::vector<gid_t> groups(static_cast<std::size_t>(count));
  if (getgrouplist(entry->pw_name, entry->pw_gid, groups.data(), &count) < 0) count = 64;
  for (int i = 0; i < count; ++i) {
    if (const group* one = getgrgid(groups[static_cast<std::size_t>(i)]); one != nullptr) names.push_back(std::string("@") + one->gr_name);
  }
  return names;
}

}  // namespace

Role role_of_user(unsigned user, const std::vector<std::string>& operators, const std::vector<std::string>& engineers) {
  if (user == 0 || user == geteuid()) return Role::engineer;
  const std::vector<std::string> names = names_of(user);
  const auto among = [&](const std::vector<std::string>& list) {
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& n) { return std::find(list.begin(), list.end(), n) != list.end(); });
  };
  if (among(engineers)) return Role::engineer;
  return among(operators) ? Role::pilot : Role::watcher;
}

}  // namespace lf::hal
