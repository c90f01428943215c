// What the nodes of this machine are called, and what the codes of EMCY and 603F mean on it. Each joint may have a drive of another make, and each make has codes of its own.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "shared/arm/joint_names.hpp"
#include "shared/messages/joint_io.hpp"

namespace lf::config {

class ErrorTexts {
 public:
  ErrorTexts() = default;
  explicit ErrorTexts(JointNames names) : names_(std::move(names)) {}

  // `texts` are those of the drive's profile; `node` is its number on the bus.
  void set(std::size_t joint, std::uint8_t node, std::map<std::uint16_t, std::string> texts);

  // What `code` means on a joint's drive, else in the standard. The output node, which is no joint's, has the standard's texts.
  std::string of_joint(std::int32_t joint, std::uint16_t code) const;
  std::string of_node(std::int32_t node, std::uint16_t code) const;

  const JointNames& names() const { return names_; }
  // Of a node of the network: its joint's, "io" for the output node, else the number.
  std::string node_name(std::int32_t index) const;

 private:
  struct Drive {
    std::uint8_t node = 0;
    std::map<std::uint16_t, std::string> texts;
  };
  JointNames names_;
  PerJoint<Drive> drives_;
};

}  // namespace lf::config
