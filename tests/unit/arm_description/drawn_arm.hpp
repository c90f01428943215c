// An arm of the core's form that nobody chose: the shipped one's links on joints at drawn places, with drawn ranges and fingers.
#pragma once

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "firmware/arm/kinematics.hpp"
#include "shared/arm/arm_description.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::test {

class DrawnArm {
 public:
  explicit DrawnArm(std::mt19937_64& random) {
    const auto draw = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
    std::ifstream stream(LANTERNFISH_SOURCE_DIR "/shared/arm/arm5e.urdf");
    std::string text = (std::stringstream() << stream.rdbuf()).str();
    text.resize(text.find("<joint name=\"slew\""));
    const double elbow_at = draw(-pi, pi), elbow_turn = draw(-pi, pi), roll_turn = draw(-pi, pi), upper_arm = draw(0.15, 0.9),
                 across = draw(-0.2, 0.2), to_roll = draw(0.05, 0.5);
    const double quarter = pi / 2;
    text += joint("slew", "base", "slew", Vec3::Zero(), Vec3(0, 0, draw(-pi, pi)), "0 0 1", range(draw));
    text += joint("shoulder", "slew", "upper_arm", Vec3(draw(-0.2, 0.3), 0, 0), Vec3(quarter, draw(-1.5, 1.5), 0), "0 0 1", range(draw));
    text += joint("elbow", "upper_arm", "forearm", upper_arm * Vec3(std::cos(elbow_at), std::sin(elbow_at), 0), Vec3(0, 0, elbow_turn),
                  "0 0 1", range(draw));
    text += joint("roll", "forearm", "wrist",
                  across * Vec3(std::cos(roll_turn), std::sin(roll_turn), 0) + to_roll * Vec3(std::sin(roll_turn), -std::cos(roll_turn), 0),
                  Vec3(quarter, 0, roll_turn), "0 0 1", range(draw));
    const Vec3 pivot(draw(-0.06, -0.036), 0, draw(-0.1, 0.1));  // the pads meet at an angle below 0
    // From where the pads meet, or later: the shipped fingers on other axes.
    const double face_x = 0.0337, face_z = 0.0985, reach = std::hypot(face_x, face_z);
    const double shut = std::acos(std::clamp(-pivot.x() / reach, -1.0, 1.0)) - std::atan2(face_z, face_x);
    const Vec2 opens(std::min(shut + draw(0.001, 0.05), -1e-4), std::max(shut, 0.0) + draw(0.2, 0.6));
    text += joint("jaw", "wrist", "finger_a", pivot, Vec3::Zero(), "0 -1 0", opens);
    text += joint("finger_b", "wrist", "finger_b", pivot.cwiseProduct(Vec3(-1, 1, 1)), Vec3::Zero(), "0 1 0", opens);
    text += "<link name=\"tool\"/><joint name=\"tool\" type=\"fixed\"><parent link=\"wrist\"/><child link=\"tool\"/><origin xyz=\"0 0 " +
            number(draw(0.05, 0.3)) + "\"/></joint></robot>";
    folder_.write("drawn.urdf", text);
  }

  std::string path() const { return folder_ / "drawn.urdf"; }

  // Within the joints' ranges; neither stretched, nor over the slew's axis, where other angles do as well.
  arm::JointVector posture(const ArmDescription& arm, std::mt19937_64& random) const {
    arm::JointVector q = arm::JointVector::Zero();
    do {
      for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i)
        q[static_cast<Eigen::Index>(i)] = std::uniform_real_distribution<double>(arm.joints[i].lower_rad, arm.joints[i].upper_rad)(random);
    } while (!is_regular(arm, q));
    return q;
  }

 private:
  template <class Draw>
  static Vec2 range(const Draw& draw) {
    return {draw(-pi, 0), draw(0, pi)};
  }
  static std::string number(double value) {
    std::ostringstream text;
    text.precision(17);
    text << value;
    return text.str();
  }
  static std::string numbers(const Vec3& v) { return number(v.x()) + " " + number(v.y()) + " " + number(v.z()); }
  static std::string joint(const std::string& name, const std::string& parent, const std::string& child, const Vec3& xyz, const Vec3& rpy,
                           const std::string& axis, const Vec2& range) {
    std::string text = "<joint name=\"" + name + "\" type=\"revolute\"><parent link=\"" + parent + "\"/><child link=\"" + child +
                       "\"/><origin xyz=\"" + numbers(xyz) + "\" rpy=\"" + numbers(rpy) + "\"/><axis xyz=\"" + axis +
                       "\"/><limit lower=\"" + number(range.x()) + "\" upper=\"" + number(range.y()) +
                       "\" effort=\"50\" velocity=\"0.5\"/>";
    if (name == "finger_b") return text + "<mimic joint=\"jaw\" multiplier=\"1\" offset=\"0\"/></joint>\n";
    return text +
           "<lanternfish:drive rated_torque_nm=\"20\" acceleration_rad_s2=\"1\" stiction_rad_s=\"0.05\" backlash_rad=\"0.001\" "
           "holding_torque_nm=\"50\"/><lanternfish:gear rad_per_count=\"1e-3\"/></joint>\n";
  }
  static bool is_regular(const ArmDescription& arm, const arm::JointVector& q) {
    Pose body = Pose::Identity();
    PerArmJoint<Vec3> at;
    for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i) {
      body = body * arm.joints[i].parent_from_joint * Eigen::AngleAxisd(q[static_cast<Eigen::Index>(i)], Vec3::UnitZ());
      at[i] = body.translation();
    }
    const Vec3 tool = body * arm.wrist_from_tool.translation();
    const Vec3 upper_arm = (at[2] - at[1]).normalized(), forearm = (tool - at[2]).normalized();
    return upper_arm.cross(forearm).norm() > 0.02 && tool.head<2>().norm() > 0.02;
  }

  TemporaryFolder folder_;
};

}  // namespace lf::test
