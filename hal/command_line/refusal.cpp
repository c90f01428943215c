#include "hal/command_line/refusal.hpp"

#include <algorithm>
#include <vector>

#include "hal/command_line/tree.hpp"
#include "hal/config/nearest.hpp"

namespace lf::command_line {

namespace {

// The chosen commands from the program down.
std::vector<const CLI::App*> chosen_of(const CLI::App& app) {
  std::vector<const CLI::App*> chosen{&app};
  for (std::vector<CLI::App*> next = app.get_subcommands(); !next.empty(); next = next.front()->get_subcommands())
    chosen.push_back(next.front());
  return chosen;
}

bool has_option(const CLI::App& app, const std::string& name) {
  const auto options = options_of(app);
  return std::any_of(options.begin(), options.end(),
                     [&](const CLI::Option* option) { return "--" + option->get_lnames().front() == name; });
}

// An option stands behind the command that takes it. Empty for one that none of the chosen takes.
std::string misplaced_option(const std::string& name, const std::vector<const CLI::App*>& chosen) {
  std::string command;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    command += (i == 0 ? "" : " ") + chosen[i]->get_name();
    if (!has_option(*chosen[i], name)) continue;
    const std::string where =
        i + 1 < chosen.size() ? "before `" + chosen[i + 1]->get_name() + "`" : "behind `" + chosen[i]->get_name() + "`";
    return "'" + name + "' is an option of `" + command + "`: write it " + where;
  }
  return "";
}

std::string unknown_option(const std::string& word, const std::vector<const CLI::App*>& chosen) {
  const std::string name = word.substr(0, word.find('='));
  if (std::string misplaced = misplaced_option(name, chosen); !misplaced.empty()) return misplaced;
  std::vector<std::string> known;
  std::string command;
  for (auto one = chosen.rbegin(); one != chosen.rend(); ++one) {
    for (const CLI::Option* option : options_of(**one)) known.push_back("--" + option->get_lnames().front());
    command = (*one)->get_name() + (command.empty() ? "" : " " + command);
  }
  const std::string near = config::suggestion(name, known);
  return command + " has no option '" + name + "'" + (near.empty() ? "; `" + command + " --help` lists those it has" : near);
}

// CLI11 says "Could not convert: --x = 0,44".
std::string wrong_value(const CLI::ConversionError& error, const CLI::App& command) {
  std::string said = error.what();
  const std::size_t name = said.find("--"), equals = said.find(" = ");
  if (name == std::string::npos || equals == std::string::npos || equals < name) return said;
  const std::string option = said.substr(name, equals - name), value = said.substr(equals + 3);
  const CLI::Option* found = command.get_option_no_throw(option);
  const std::string type = found != nullptr ? found->get_type_name() : "";
  const std::string takes = type.starts_with("FLOAT")                             ? " takes a number"
                            : type.starts_with("INT") || type.starts_with("UINT") ? " takes a whole number"
                                                                                  : " takes another value";
  const bool comma = type.starts_with("FLOAT") && value.find(',') != std::string::npos;
  return "'" + option + "'" + takes + ", not '" + value + "'" + (comma ? ": its decimals stand behind a point" : "");
}

}  // namespace

std::string refusal(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> extras = app.remaining(true);
  const std::vector<const CLI::App*> chosen = chosen_of(app);
  const auto option =
      std::find_if(extras.begin(), extras.end(), [](const std::string& word) { return word.starts_with("-") && word.size() > 1; });
  if (option != extras.end()) return unknown_option(*option, chosen);
  if (const auto* conversion = dynamic_cast<const CLI::ConversionError*>(&error)) return wrong_value(*conversion, *chosen.back());
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr || extras.empty()) return error.what();
  std::vector<std::string> names;
  for (const CLI::App* command : commands_of(*chosen.back())) names.push_back(command->get_name());
  return error.what() + config::suggestion(extras.front(), names);
}

}  // namespace lf::command_line
