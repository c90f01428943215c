// Why a node did not boot, in a sentence that names the object and what to do about it.
#pragma once

#include <string>

#include "firmware/canopen/boot_report.hpp"
#include "shared/arm/joint_names.hpp"

namespace lf::config {

// "elbow (node 3): 6072:00 maximum torque does not exist (06020000). ...". `who` is the joint's name, or "outputs". Empty when the node did not fail.
std::string boot_sentence(const canopen::NodeBoot& boot, const std::string& who);

// Of all nodes that failed, each after "; ".
std::string boot_sentences(const canopen::BootReport& report, const JointNames& names);

}  // namespace lf::config
