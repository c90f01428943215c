// The elements and attributes of one URDF: each number checked, each complaint with its file and line.
#pragma once

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "shared/geometry/pose.hpp"
#include "shared/input_error.hpp"

namespace lf {

using tinyxml2::XMLElement;

class Urdf {
 public:
  explicit Urdf(const std::string& file) : file_(file) {
    if (document_.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) throw InputError(file, document_.ErrorLineNum(), load_error());
    robot_ = document_.RootElement();
    if (robot_ == nullptr) throw InputError(file, 0, "has no element");
    if (std::strcmp(robot_->Name(), "robot") != 0) fail(robot_, "expected <robot>, found <" + std::string(robot_->Name()) + ">");
  }

  [[noreturn]] void fail(const XMLElement* at, const std::string& message) const {
    throw InputError(file_, at != nullptr ? at->GetLineNum() : 0, message);
  }

  // `otherwise`: what to do where there is none.
  const XMLElement* named(const char* tag, const std::string& name, const std::string& otherwise = "") const {
    for (const XMLElement* e = robot_->FirstChildElement(tag); e != nullptr; e = e->NextSiblingElement(tag))
      if (name == text(e, "name")) return e;
    fail(robot_, "no <" + std::string(tag) + "> named '" + name + "'" + otherwise);
  }

  template <class Look>
  void each(const char* tag, const Look& look) const {
    for (const XMLElement* e = robot_->FirstChildElement(tag); e != nullptr; e = e->NextSiblingElement(tag)) look(e);
  }

  const XMLElement* child(const XMLElement* parent, const char* tag) const {
    const XMLElement* e = parent->FirstChildElement(tag);
    if (e == nullptr) fail(parent, label(parent) + " has no <" + tag + ">");
    return e;
  }

  std::string text(const XMLElement* e, const char* attribute) const {
    const char* value = e->Attribute(attribute);
    if (value == nullptr) fail(e, label(e) + " has no " + attribute);
    return value;
  }

  template <int N>
  Eigen::Matrix<double, N, 1> numbers(const XMLElement* e, const char* attribute) const {
    const std::string value = text(e, attribute);
    const auto bad = [&] {
      fail(e, label(e) + ": " + attribute + "=\"" + value + "\" is not " + (N == 1 ? "a number" : std::to_string(N) + " numbers"));
    };
    Eigen::Matrix<double, N, 1> result;
    const char* at = value.data();
    const char* const end = at + value.size();
    const auto skip_spaces = [&] {
      while (at != end && std::isspace(static_cast<unsigned char>(*at)) != 0) ++at;
    };
    for (int i = 0; i < N; ++i) {
      skip_spaces();
      const auto [next, error] = std::from_chars(at, end, result[i]);
      if (error != std::errc() || !std::isfinite(result[i])) bad();
      at = next;
    }
    skip_spaces();
    if (at != end) bad();
    const double most = most_of(attribute);
    if (result.cwiseAbs().maxCoeff() > most)
      fail(e, label(e) + ": " + attribute + "=\"" + value + "\" is more than any arm has: " + shortest(most) + " at most");
    return result;
  }

  double number(const XMLElement* e, const char* attribute) const { return numbers<1>(e, attribute)[0]; }
  double positive(const XMLElement* e, const char* attribute) const {
    const double value = number(e, attribute);
    if (value <= 0) fail(e, label(e) + ": " + attribute + " must be positive");
    return value;
  }
  double not_negative(const XMLElement* e, const char* attribute) const {
    const double value = number(e, attribute);
    if (value < 0) fail(e, label(e) + ": " + attribute + " must not be negative");
    return value;
  }

  // The <origin> of `e`; identity when it has none, as URDF has it.
  Pose origin(const XMLElement* e) const {
    Pose pose = Pose::Identity();
    const XMLElement* const origin = e->FirstChildElement("origin");
    if (origin == nullptr) return pose;
    if (origin->Attribute("xyz") != nullptr) pose.translation() = numbers<3>(origin, "xyz");
    if (origin->Attribute("rpy") == nullptr) return pose;
    const Vec3 rpy = numbers<3>(origin, "rpy");
    using Eigen::AngleAxisd;
    pose.linear() =
        (AngleAxisd(rpy.z(), Vec3::UnitZ()) * AngleAxisd(rpy.y(), Vec3::UnitY()) * AngleAxisd(rpy.x(), Vec3::UnitX())).toRotationMatrix();
    return pose;
  }

  // "joint 'elbow'", or "<limit>" for what has no name.
  static std::string label(const XMLElement* e) {
    std::string label = e->Name();
    if (const char* const name = e->Attribute("name")) return label.append(" '").append(name).append("'");
    return label.insert(0, 1, '<').append(1, '>');
  }

 private:
  // What no arm exceeds, in SI units. A number beyond is a slip of the pen, and an arm of it would go nowhere or through everything.
  static double most_of(std::string_view attribute) {
    using Most = std::pair<std::string_view, double>;
    constexpr double length_m = 10, torque_nm = 1e6;
    constexpr std::array all{Most{"xyz", length_m},
                             Most{"rpy", 7},
                             Most{"size", length_m},
                             Most{"radius", length_m},
                             Most{"length", length_m},
                             Most{"pivot_a_m", length_m},
                             Most{"pivot_b_m", length_m},
                             Most{"velocity", 100},
                             Most{"acceleration_rad_s2", 1e4},
                             Most{"effort", torque_nm},
                             Most{"rated_torque_nm", torque_nm},
                             Most{"holding_torque_nm", torque_nm},
                             Most{"stiffness_nm_rad", 1e9},
                             Most{"backlash_rad", 0.2},
                             Most{"value", 1e4},
                             Most{"n", 1e5},
                             Most{"coefficient", 10}};
    const auto found = std::find_if(all.begin(), all.end(), [&](const Most& most) { return most.first == attribute; });
    return found == all.end() ? 1e9 : found->second;
  }
  static std::string shortest(double value) {
    std::array<char, 32> text{};
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
  }

  std::string load_error() const {
    switch (document_.ErrorID()) {
      case tinyxml2::XML_ERROR_FILE_NOT_FOUND: return "no such file";
      case tinyxml2::XML_ERROR_FILE_COULD_NOT_BE_OPENED:
      case tinyxml2::XML_ERROR_FILE_READ_ERROR: return "cannot be read";
      case tinyxml2::XML_ERROR_EMPTY_DOCUMENT: return "is empty";
      default: return std::string("is not well-formed XML (") + document_.ErrorName() + ")";
    }
  }

  std::string file_;
  tinyxml2::XMLDocument document_;
  const XMLElement* robot_ = nullptr;
};

}  // namespace lf
