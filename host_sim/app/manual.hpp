// The pages of the manual that `lanternfish help --man` prints: lanternfish(1) and lanternfish-scenario(5). docs/man holds them.
#pragma once

#include <CLI/App.hpp>
#include <string>

#include "hal/command_line/help_command.hpp"

namespace lf::app {

command_line::ManPages manual_of(const CLI::App& app);

// What completes a scenario's name, and the keys of --set.
command_line::WordSources word_sources();

}  // namespace lf::app
