// A program's commands and options as their users see them: what help, manual pages and completion are made of.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

namespace lf::command_line {

// In the order of --help. Hidden ones (without a group) are left out.
std::vector<const CLI::App*> commands_of(const CLI::App& app);
std::vector<const CLI::Option*> options_of(const CLI::App& app);  // with a long name, --help among them
std::vector<const CLI::Option*> positionals_of(const CLI::App& app);

bool takes_value(const CLI::Option& option);
bool may_repeat(const CLI::Option& option);
// The words that an option takes; empty when it takes others, too.
std::vector<std::string> words_of(const CLI::Option& option);
// "--seed UINT", "--json", "SCENARIO".
std::string label_of(const CLI::Option& option);
// "N", "FILE" ...: what stands for the value.
std::string value_name(const CLI::Option& option);
// "run [SCENARIO] [OPTION]...", with what has to be given.
std::string synopsis_of(const CLI::App& command);

}  // namespace lf::command_line
