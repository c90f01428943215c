#include <cmath>
#include <cstdio>
#include <memory>

#include "firmware/arm/pointing.hpp"
#include "firmware/arm/tool_place.hpp"
#include "hal/config/read_arm.hpp"
#include "hal/config/share.hpp"
#include "host_sim/app/checks.hpp"
#include "host_sim/app/command.hpp"
#include "shared/input_error.hpp"

namespace lf::app {

namespace {

struct Options {
  double x_m = 0, y_m = 0, z_m = 0, roll_rad = 0;
  double margin_rad = arm::default_limit_margin_rad;
  std::vector<double> approach;  // empty: not told
  std::string arm = "arm/arm5e.urdf";
  bool json = false;
};

// Metres and radians: a thousand arms' lengths. Squares of what is far larger are no numbers, and neither is by how much it is too far.
constexpr double farthest = 1000;

bool is_length(arm::IkOutcome outcome) { return outcome == arm::IkOutcome::too_far || outcome == arm::IkOutcome::too_near; }

Json answer(const config::NamedArm& named, const arm::IkResult& ik) {
  const arm::Arm& arm = named.arm;
  Json json{{"reachable", ik.ok()}};
  if (ik.ok()) {
    const Vec3 approach = arm.approach_axis(ik.q_rad);
    for (std::size_t i = 0; i < arm.arm_joints(); ++i) json["joints_rad"][named.joints[i]] = ik.q_rad[Eigen::Index(i)];
    json["approach"] = {approach.x(), approach.y(), approach.z()};
    if (arm.is_planar()) json["branch"] = ik.posture.branch == arm::IkBranch::front ? "front" : "folded";
  } else {
    json["reason"] = arm::name(ik.outcome);
    if (ik.outcome == arm::IkOutcome::joint_limit) json["joint"] = named.joints[ik.joint];
    json[is_length(ik.outcome) ? "excess_m" : "excess_rad"] = ik.excess;
  }
  return json;
}

void tell(const config::NamedArm& named, const arm::IkResult& ik) {
  const arm::Arm& arm = named.arm;
  if (!ik.ok()) {
    if (ik.outcome == arm::IkOutcome::joint_limit) print("not reachable: %s is beyond its limit\n", named.joints[ik.joint].c_str());
    if (is_length(ik.outcome)) {
      print("not reachable: %s by %.1f mm\n", arm::name(ik.outcome), 1e3 * ik.excess);
    } else {
      print("not reachable: %s by %.4f rad (%.2f deg)\n", arm::name(ik.outcome), ik.excess, deg_from_rad(ik.excess));
    }
    return;
  }
  for (std::size_t i = 0; i < arm.arm_joints(); ++i) {
    const double q_rad = ik.q_rad[Eigen::Index(i)];
    print("%-9s %9.5f rad  %8.3f deg\n", named.joints[i].c_str(), q_rad, deg_from_rad(q_rad));
  }
  const Vec3 approach = arm.approach_axis(ik.q_rad);
  print("approach  %.5f %.5f %.5f\n", approach.x(), approach.y(), approach.z());
}

int ik(const Options& options) {
  for (const double value : {options.x_m, options.y_m, options.z_m, options.roll_rad, options.margin_rad}) {
    if (!std::isfinite(value)) throw InputError("ik takes finite numbers");
  }
  for (const auto& [name, value] :
       {std::pair{"--x", options.x_m}, {"--y", options.y_m}, {"--z", options.z_m}, {"--roll", options.roll_rad}}) {
    if (std::abs(value) <= farthest) continue;
    char text[96];
    std::snprintf(text, sizeof text, "ik: %s takes a number from -%g to %g, not %g", name, farthest, farthest, value);
    throw InputError(text);
  }
  const config::NamedArm arm = config::read_arm(config::find_file(options.arm, ""));
  if (!arm::can_work(arm.arm))
    throw InputError("ik: " + options.arm +
                     " is neither an arm of slew, shoulder, elbow and roll nor one with five joints or more beside a roll: `lanternfish "
                     "check arm` tries any");
  if (arm.arm.is_planar() && !options.approach.empty())
    throw InputError("ik: --approach is given, and an arm of slew, shoulder, elbow and roll cannot choose it: it follows from the place");
  if (!arm.arm.rolls() && options.roll_rad != 0) throw InputError("ik: --roll is given, and this arm has no roll");
  const Vec3 tool_m(options.x_m, options.y_m, options.z_m);
  const Vec3 approach = options.approach.empty() ? Vec3::UnitX() : Vec3(Eigen::Map<const Vec3>(options.approach.data()));
  if (!approach.allFinite() || !(approach.norm() > 1e-3)) throw InputError("ik: --approach takes three numbers that are not all 0");
  const arm::IkResult result = arm.arm.is_planar() ? arm::inverse_kinematics(arm.arm, tool_m, options.roll_rad, options.margin_rad)
                                                   : arm::point_tool_or_why(arm.arm, tool_m, approach, options.roll_rad, options.margin_rad,
                                                                            arm::JointVector::Zero());
  if (options.json) {
    print_json(answer(arm, result));
  } else {
    tell(arm, result);
  }
  return result.ok() ? done : failed;
}

}  // namespace

void add_ik(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("ik", "Joint angles that put the tool point at a place, or the limit that stops it");
  auto options = std::make_shared<Options>();
  command->add_option("--x", options->x_m, "Toward the panel, m, in the arm's base frame")->required();
  command->add_option("--y", options->y_m, "To the right, m")->required();
  command->add_option("--z", options->z_m, "Down, m")->required();
  command->add_option("--roll", options->roll_rad, "Roll of the jaw, rad");
  command
      ->add_option("--approach", options->approach,
                   "Direction in which the tool points, of an arm that can choose it; 1 0 0 if none is given")
      ->expected(3);
  command->add_option("--margin", options->margin_rad, "Distance to keep from the joints' limits, rad")->check(within(0, 0.5));
  command->add_option("--arm", options->arm, "The arm's URDF, a file or a shipped one")->capture_default_str();
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &action] { action = [options] { return ik(*options); }; });
}

}  // namespace lf::app
