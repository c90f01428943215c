// Completion scripts for bash and zsh, made of a program's table of commands and options.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

namespace lf::command_line {

// What completes a value, by the name of its option or argument ("--set", "SCENARIO"): a shell command that prints one a line.
// Words that an option's table knows need none; a text without either is completed as a file, a number not at all.
using WordSources = std::map<std::string, std::string>;

std::string bash_completion(const CLI::App& app, const WordSources& sources);
std::string zsh_completion(const CLI::App& app, const WordSources& sources);

}  // namespace lf::command_line
