// The commands that explain a program's others: `help` and `completion`.
#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <map>
#include <string>

#include "hal/command_line/completion.hpp"

namespace lf::command_line {

// The pages of manual that a program prints, by their section: "1", "5".
using ManPages = std::map<std::string, std::function<std::string()>>;

// `help [COMMAND]` prints what `COMMAND --help` does; hidden in it, `help --man SECTION` prints a page of the manual. `completion bash|zsh` prints a script.
// Each sets `action`, which answers with 0, or throws InputError for a command or page that there is not. `print` takes what goes to standard output.
void add_help_commands(CLI::App& app, std::function<int()>& action, const ManPages& pages, const WordSources& sources,
                       const std::function<void(const std::string&)>& print);

}  // namespace lf::command_line
