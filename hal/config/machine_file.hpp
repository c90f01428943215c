// A machine's file: what the robot is, for both programs. A scenario or a vehicle's configuration names it, and its own keys overrule single values of it.
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>
#include <vector>

#include "hal/config/key.hpp"
#include "hal/config/machine.hpp"

namespace lf::config {

// What of a Machine the file says: arm, folded pose, limits, camera, laser, vehicle and drives. The pointers are into the argument.
Keys machine_keys(Machine& machine);

// Reads `file` over what `machine` holds; what the file does not say stays. The files that it names are looked for beside it, then among the shipped ones, and
// stand in `machine` by their whole paths, or, where `machine.file` finds the same shipped file by it, by their names. Adds every problem to `problems`: no file, not YAML, no version, an unknown or
// repeated key, a value out of its range, a file that is not there.
void read_machine_file(const std::filesystem::path& file, Machine& machine, std::vector<std::string>& problems);

// A shipped machine's name, "arm5e", as the file that it means; any other name stays.
std::string machine_file_of(const std::string& name);
// Why there is no such machine, and what may be meant.
std::string no_machine(const std::string& name);
// The file of such a name, beside `told_in` or shipped. Throws InputError where there is none.
std::filesystem::path named_machine(const std::string& told_in, const std::string& name);

// What 'machine' of a YAML document says; empty where it says nothing.
std::string machine_named_in(const YAML::Node& root);

// What the joints of the arm are called that 'arm.urdf' of a YAML document names, beside `file`; `usual` where it names none. Keys of the joints' drives are called
// by them. Throws InputError where the URDF cannot be read.
JointNames joints_named_in(const YAML::Node& root, const std::filesystem::path& file, const JointNames& usual);
// Takes out of `root` what goes by the names of an arm that cannot be read: its drives and its folded pose.
void forget_joints(YAML::Node& root);
// joints_named_in(), and forgets them where that cannot be read. Adds why to `problems`.
JointNames joints_or_why(YAML::Node& root, const std::filesystem::path& file, const JointNames& usual, std::vector<std::string>& problems);

// Of the file's table, the keys that `file` does not give; those of a single joint's drive are as for all. Throws InputError where it cannot be read.
std::vector<std::string> keys_left_out(const std::filesystem::path& file);

std::string machine_schema();

// A commented file with every key at its default.
std::string machine_listing();

}  // namespace lf::config
