// Completion scripts for bash and zsh, made of a program's table of commands and options.
#pragma once

#include <CLI/App.hpp>
#include <map>
#include <string>

namespace lf::command_line {

struct WordSource {
  std::string command;   // of the shell: prints one word a line
  bool or_file = false;  // the value may be a file's name, too
};
// What completes a value, by the name of its option or argument ("--set", "SCENARIO"). Words that an option's table knows need none; a text without either is
// completed as a file, a number not at all.
using WordSources = std::map<std::string, WordSource>;

std::string bash_completion(const CLI::App& app, const WordSources& sources);
std::string zsh_completion(const CLI::App& app, const WordSources& sources);

}  // namespace lf::command_line
