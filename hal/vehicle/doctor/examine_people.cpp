// Users and groups: those that the configuration names, and the one that looks.
#include <grp.h>
#include <pwd.h>
#include <unistd.h>

#include "hal/vehicle/doctor/examination.hpp"

namespace lf::hal::doctor {

namespace {

void examine_names(const char* subject, const char* key, const std::vector<std::string>& names, Examinations& found) {
  std::string there;
  for (const std::string& name : names) {
    const bool group = name.starts_with("@");
    if (group ? getgrnam(name.c_str() + 1) != nullptr : getpwnam(name.c_str()) != nullptr) {
      there += (there.empty() ? "" : ", ") + name;
      continue;
    }
    found.push_back({subject, key, Grade::bad, std::string("there is no ") + (group ? "group " : "user ") + name,
                     "`getent passwd` and `getent group` list them"});
  }
  if (!there.empty()) found.push_back({subject, key, Grade::good, there, ""});
}

}  // namespace

void examine_people(const VehicleConfig& config, const Machine&, Examinations& found) {
  examine_names("operators", "operator.operators", config.operators, found);
  examine_names("engineers", "operator.engineers", config.engineers, found);
  if (!config.operator_group.empty()) examine_names("socket's group", "operator.group", {"@" + config.operator_group}, found);
  if (geteuid() != 0) return;
  found.push_back({"this user", "", Grade::note, "root may do everything: what the service's user may not is not seen",
                   "look as that user, too: docs/installing.md, `First start`"});
}

}  // namespace lf::hal::doctor
