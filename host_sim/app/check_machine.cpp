#include "host_sim/app/check_machine.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "firmware/arm/gripper.hpp"
#include "firmware/arm/pointing.hpp"
#include "hal/config/arm_notes.hpp"
#include "hal/config/holding.hpp"
#include "hal/config/joined.hpp"
#include "hal/config/machine_file.hpp"
#include "hal/config/read_arm.hpp"
#include "hal/config/share.hpp"
#include "host_sim/app/command.hpp"
#include "host_sim/app/outside_picture.hpp"
#include "host_sim/app/read_machine.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/scenario/scenario.hpp"
#include "shared/arm/arm_description.hpp"
#include "shared/input_error.hpp"

namespace lf::app {
namespace {

// By the rules that a mission is held against before it begins, without the file that the user did not write.
std::vector<std::string> problems_of_job(const std::string& file) {
  std::vector<std::string> problems;
  try {
    scenario::check_runnable(scenario::load_scenario("default", {"machine=" + Json(file).dump()}));
  } catch (const InputError& error) {
    std::istringstream lines(error.what());
    for (std::string line; std::getline(lines, line);) {
      const std::size_t colon = line.find(": ");
      problems.push_back(colon == std::string::npos ? line : line.substr(colon + 2));
    }
  }
  return problems;
}

struct Told {
  std::string file;
  config::Machine machine;
  ArmDescription description;
  arm::Arm arm;
  std::vector<config::Holding> holding;
  std::vector<std::string> assumed, notes, problems;

  explicit Told(const std::string& name)
      : file(name),
        machine(read_machine(name)),
        description(load_arm_urdf(urdf())),
        arm(machine.arm),
        holding(config::holding_of(description, machine.drives)),
        assumed(config::keys_left_out(name)),
        notes(config::arm_notes(urdf())),
        problems(problems_of_job(std::filesystem::absolute(name).string())) {
    for (std::string& note : config::holding_notes(description, holding)) notes.push_back(std::move(note));
  }

  std::string urdf() const { return config::named_file(file, "arm.urdf", machine.arm_urdf); }
  // From the first joint to the tool, the arm stretched as far as its links are long.
  double reach_m() const {
    if (arm.is_planar()) return std::abs(arm.planar().a0_m) + std::abs(arm.planar().a1_m) + arm.forearm().length_m;
    double length_m = std::abs(arm.model().tool_z_m);
    for (std::size_t i = 1; i < arm.arm_joints(); ++i) length_m += arm.model().origins[i].translation().norm();
    return length_m;
  }
  double jaw_opens_m() const { return arm::gap_from_jaw(arm.jaw(), arm.jaw().upper_rad); }
};

Json json_of(const Told& told) {
  Json json{{"file", told.file}, {"arm", told.urdf()}, {"joints", Json::array()}};
  for (std::size_t i = 0; i < told.description.joints.size(); ++i) {
    const ArmJoint& joint = told.description.joints[i];
    const config::JointDriveChoice drive = config::drive_of(told.machine.drives, i);
    json["joints"].push_back({{"name", joint.name},
                              {"lower_rad", joint.lower_rad},
                              {"upper_rad", joint.upper_rad},
                              {"velocity_rad_s", joint.velocity_rad_s},
                              {"rated_torque_nm", joint.rated_torque_nm},
                              {"peak_torque_nm", joint.effort_nm},
                              {"actuator", joint.actuator.counts_per_rad > 0 ? "gear" : "screw"},
                              {"node", drive.node},
                              {"profile", drive.profile},
                              {"polarity", drive.polarity},
                              {"holding", drive.holding},
                              {"held_nm", told.holding[i].held_nm},
                              {"weight_nm", told.holding[i].weight_nm}});
  }
  json["ik"] = told.arm.is_planar() ? "planar" : arm::can_point(told.arm) ? arm::family_of(told.arm) : "none";
  json["reach_m"] = told.reach_m();
  json["jaw_opens_m"] = told.jaw_opens_m();
  json["thickest_bar_m"] = arm::thickest_bar_m(told.arm.jaw());
  json["assumed"] = told.assumed;
  json["notes"] = told.notes;
  json["can_do_default_job"] = told.problems.empty();
  json["problems"] = told.problems;
  return json;
}

void tell(const Told& told) {
  print("%s: the arm of %s\n", told.file.c_str(), told.urdf().c_str());
  int width = 0;
  for (const ArmJoint& joint : told.description.joints) width = std::max(width, static_cast<int>(joint.name.size()));
  for (std::size_t i = 0; i < told.description.joints.size(); ++i) {
    const ArmJoint& joint = told.description.joints[i];
    const config::JointDriveChoice drive = config::drive_of(told.machine.drives, i);
    print("  %-*s %7.1f to %6.1f deg, %5.1f deg/s, %5.1f N m rated, %5.1f peak, %-5s node %lld, %s%s; %s, the weight takes %.1f N m\n",
          width, joint.name.c_str(), deg_from_rad(joint.lower_rad), deg_from_rad(joint.upper_rad), deg_from_rad(joint.velocity_rad_s),
          joint.rated_torque_nm, joint.effort_nm, joint.actuator.counts_per_rad > 0 ? "gear," : "screw,",
          static_cast<long long>(drive.node), drive.profile.c_str(), drive.polarity == "reversed" ? ", reversed" : "",
          told.holding[i].text().c_str(), told.holding[i].weight_nm);
  }
  if (told.arm.is_planar())
    print("  inverse kinematics: planar, in closed form; the tool comes %.0f mm from the slew's axis at most\n", 1e3 * told.reach_m());
  else if (arm::can_point(told.arm))
    print("  inverse kinematics: %s; it points its tool straight at the panel, which comes %.0f mm from the first joint at most\n",
          arm::family_of(told.arm), 1e3 * told.reach_m());
  else
    print(
        "  neither slew, shoulder, elbow and roll nor five joints beside a roll, for which jobs are planned: it can be commissioned, "
        "homed and jogged. The tool comes %.0f mm from the first joint at most\n",
        1e3 * told.reach_m());
  print("  the jaw opens to %.0f mm, and takes bars up to %.1f mm\n", 1e3 * told.jaw_opens_m(), 1e3 * arm::thickest_bar_m(told.arm.jaw()));
  const std::array<double, 3>& camera = told.machine.camera.position_m;
  print("  camera at %.3f %.3f %.3f m, %.1f deg down, %.1f deg to the right, focal length %.1f px\n", camera[0], camera[1], camera[2],
        told.machine.camera.down_deg, told.machine.camera.right_deg, told.machine.camera.focal_px);
  const std::array<double, 3>& laser = told.machine.laser.position_m;
  print("  laser at %.3f %.3f %.3f m of the tool, a fan of %.0f deg\n", laser[0], laser[1], laser[2],
        2 * told.machine.laser.fan_half_angle_deg);
  print("  of the vehicle, %zu boxes and %zu capsules are kept clear; it has %zu lamps\n", told.machine.vehicle.boxes_m.size(),
        told.machine.vehicle.capsules_m.size(), told.machine.vehicle.lamps_m.size());
  if (!told.assumed.empty()) print("  not in the file, so as the default machine has it: %s\n", config::joined(told.assumed, ", ").c_str());
  for (const std::string& note : told.notes) print("  note: %s\n", note.c_str());
  if (told.problems.empty()) print("  it can do the default scenario's job\n");
  for (const std::string& problem : told.problems) print("  it cannot do the default scenario's job: %s\n", problem.c_str());
}

}  // namespace

int check_machine(const std::string& name, const std::string& picture, bool json) {
  const Told told(machine_path(name));
  if (!picture.empty()) {
    const scenario::Scenario usual = scenario::load_scenario("default", {});
    scenario::Scenario shown = usual;
    shown.arm.urdf = told.urdf();
    shown.arm.park_rad = told.machine.park_rad;
    shown.joints = told.machine.joints;
    shown.told_arm = told.arm;
    shown.drives = told.machine.drives;
    shown.vehicle = told.machine.vehicle;
    draw_outside(shown, usual, picture);
  }
  if (json) {
    Json document = json_of(told);
    if (!picture.empty()) document["picture"] = picture;
    print_json(document);
    return done;
  }
  tell(told);
  if (!picture.empty()) print("picture: %s\n", picture.c_str());
  return done;
}

}  // namespace lf::app
