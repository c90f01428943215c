#include "hal/command_line/tree.hpp"

#include <algorithm>

namespace lf::command_line {

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  const auto shown = [](const CLI::App* command) { return !command->get_name().empty() && !command->get_group().empty(); };
  return app.get_subcommands(shown);
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return !option->get_lnames().empty() && !option->get_group().empty(); });
}

std::vector<const CLI::Option*> positionals_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional() && !option->get_group().empty(); });
}

bool takes_value(const CLI::Option& option) { return option.get_expected_max() != 0; }

bool may_repeat(const CLI::Option& option) { return takes_value(option) && option.get_items_expected_max() > 1; }

// CLI11 keeps them in the type's name alone: "TEXT:{column,row}".
std::vector<std::string> words_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find(":{"), close = type.rfind('}');
  std::vector<std::string> words;
  if (open == std::string::npos || close == std::string::npos) return words;
  for (std::size_t at = open + 2; at < close;) {
    const std::size_t end = std::min(type.find(',', at), close);
    words.push_back(type.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

std::string value_name(const CLI::Option& option) {
  const std::vector<std::string> words = words_of(option);
  if (!words.empty()) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : "|") + word;
    return text;
  }
  const std::string type = option.get_type_name();
  if (type.starts_with("UINT") || type.starts_with("INT")) return "N";
  if (type.starts_with("FLOAT")) return "NUMBER";
  return "TEXT";
}

std::string label_of(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name(true);
  const std::string name = "--" + option.get_lnames().front();
  return takes_value(option) ? name + " " + value_name(option) : name;
}

std::string synopsis_of(const CLI::App& command) {
  std::string text = command.get_name();
  for (const CLI::Option* option : options_of(command)) {
    if (option->get_required()) text += " " + label_of(*option);
  }
  for (const CLI::Option* option : positionals_of(command)) {
    const std::string name = option->get_name(true) + (may_repeat(*option) ? "..." : "");
    text += option->get_required() ? " " + name : " [" + name + "]";
  }
  const std::vector<const CLI::Option*> options = options_of(command);
  const bool others = std::any_of(options.begin(), options.end(),
                                  [](const CLI::Option* o) { return !o->get_required() && o->get_lnames().front() != "help"; });
  return others ? text + " [OPTION]..." : text;
}

}  // namespace lf::command_line
