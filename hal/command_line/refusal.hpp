// What a command line is refused for, in one line.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace lf::command_line {

// `app` has just thrown `error` while it parsed. An option or a word that nobody takes is named first, with the one that was meant or where they are listed,
// since a misspelt option is the usual reason for another's absence. Anything else is CLI11's own sentence.
std::string refusal(const CLI::App& app, const CLI::ParseError& error);

}  // namespace lf::command_line
