// The pages of the manual that `lanternfishd help --man` prints: lanternfishd(8) and lanternfish-vehicle(5). docs/man holds them.
#pragma once

#include <CLI/App.hpp>

#include "hal/command_line/help_command.hpp"

namespace lf::hal {

command_line::ManPages manual_of(const CLI::App& app);

}  // namespace lf::hal
