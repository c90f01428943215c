#include "host_sim/app/read_machine.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "hal/config/drive_kind.hpp"
#include "hal/config/holding.hpp"
#include "hal/config/joined.hpp"
#include "hal/config/limits_file.hpp"
#include "hal/config/machine_file.hpp"
#include "hal/config/park_pose.hpp"
#include "hal/config/read_arm.hpp"
#include "hal/config/share.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

std::string machine_path(const std::string& name) {
  const std::string named = config::machine_file_of(name);
  if (named == name) return name;
  const std::filesystem::path shipped = config::share_folder() / named;
  if (!std::filesystem::exists(shipped)) throw InputError(config::no_machine(name));
  return shipped.string();
}

config::Machine read_machine(const std::string& file) {
  config::Machine machine;
  machine.file = file;
  std::vector<std::string> problems;
  config::read_machine_file(file, machine, problems);
  const auto take = [&problems](const auto& step) {
    try {
      step();
    } catch (const InputError& problem) {
      problems.emplace_back(problem.what());
    }
  };
  if (problems.empty()) {
    take([&] { (void)config::read_limits(config::named_file(file, "safety.limits", machine.safety_limits), machine.joints); });
    take([&] {
      const config::NamedArm arm = config::read_arm(config::named_file(file, "arm.urdf", machine.arm_urdf));
      machine.arm = arm.arm;
      machine.joints = arm.joints;
    });
    take([&] { (void)config::park_pose(machine); });
    for (std::size_t i = 0; i < machine.joints.size(); ++i)
      take([&] {
        const config::JointDriveChoice choice = config::drive_of(machine.drives, i);
        config::check_holding(choice, config::find_drive_kind(choice.profile, std::filesystem::path(file).parent_path()),
                              file + ": drives." + machine.joints[i]);
      });
  }
  problems.erase(std::unique(problems.begin(), problems.end()), problems.end());
  if (!problems.empty()) throw InputError(config::joined(problems));
  return machine;
}

}  // namespace lf::app
