// A machine's file, read for commands that tell of it without flying it.
#pragma once

#include <string>

#include "hal/config/machine.hpp"

namespace lf::app {

// A file's own path, or that of a shipped machine that goes by this name. Throws InputError where there is none of that name.
std::string machine_path(const std::string& name);

// With its arm; what it names is found beside it. Throws InputError with everything that is wrong with the file and those it names, a line each.
config::Machine read_machine(const std::string& path);

}  // namespace lf::app
