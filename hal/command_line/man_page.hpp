// Manual pages in man(7): the commands and options from the program's own table, the prose around them from its author.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "hal/config/key.hpp"

namespace lf::command_line {

// In texts `word` is bold, an empty line separates paragraphs, and lines that begin with two blanks stand as they are.
struct ManSection {
  struct Item {
    std::string term;
    std::string text;
  };
  std::string title;  // "EXIT STATUS"
  std::string text;
  std::vector<Item> items{};
};

struct Manual {
  std::string name;                // "lanternfish"
  std::string section;             // "1"
  std::string summary;             // what stands behind the name
  std::string kind;                // "User commands"
  std::vector<ManSection> before;  // the commands or keys
  std::vector<ManSection> after;
};

// NAME, SYNOPSIS, `before`, OPTIONS of the program, COMMANDS with each one's arguments and options, `after`.
std::string man_page(const Manual& manual, const CLI::App& app);

// NAME, `before`, KEYS with what each takes, its default and its range, `after`. Keys without a default, such as those of a task, have a table of their own.
std::string man_page(const Manual& manual, const config::Keys& keys, const std::vector<std::pair<std::string, config::Keys>>& inner);

}  // namespace lf::command_line
