#include "hal/command_line/completion.hpp"

#include <vector>

#include "hal/command_line/tree.hpp"

namespace lf::command_line {

namespace {

bool is_number(const CLI::Option& option) { return value_name(option) == "N" || value_name(option) == "NUMBER"; }

WordSource source_of(const CLI::Option& option, const WordSources& sources) {
  const std::string name = option.get_positional() ? option.get_name(true) : "--" + option.get_lnames().front();
  const auto found = sources.find(name);
  if (found != sources.end()) return found->second;
  std::string words;
  for (const std::string& word : words_of(option)) words += " " + word;
  return {words.empty() ? "" : "printf '%s\\n'" + words};
}

// What becomes of the word that is typed: words of a source, a file's name, or nothing.
std::string bash_value(const CLI::Option& option, const WordSources& sources) {
  const WordSource source = source_of(option, sources);
  const bool key = option.get_lnames().size() == 1 && option.get_lnames().front() == "set";
  if (!source.command.empty())
    return std::string(key ? "compopt -o nospace; " : "") + "COMPREPLY=($(compgen -W \"$(" + source.command + ")\" -- \"$word\"))" +
           (source.or_file ? "; COMPREPLY+=($(compgen -f -- \"$word\"))" : "");
  return is_number(option) ? ":" : "compopt -o filenames; COMPREPLY=($(compgen -f -- \"$word\"))";
}

std::string names_of(const std::vector<const CLI::App*>& commands, const char* between) {
  std::string names;
  for (const CLI::App* command : commands) names += (names.empty() ? "" : between) + command->get_name();
  return names;
}

// A command's options, and the program's where it takes those, too. --help is everyone's own.
std::vector<const CLI::Option*> offered_of(const CLI::App& command) {
  std::vector<const CLI::Option*> options = options_of(command);
  if (command.get_parent() == nullptr || !command.get_fallthrough()) return options;
  for (const CLI::Option* option : options_of(*command.get_parent())) {
    if (option->get_lnames().front() != "help") options.push_back(option);
  }
  return options;
}

// The cases of one command, or of the program for `name` empty.
std::string bash_case(const CLI::App& app, const std::string& name, const WordSources& sources) {
  std::string values, options;
  for (const CLI::Option* option : offered_of(app)) {
    options += (options.empty() ? "" : " ") + ("--" + option->get_lnames().front());
    if (takes_value(*option)) values += "        --" + option->get_lnames().front() + ") " + bash_value(*option, sources) + "; return ;;\n";
  }
  std::string out = "    '" + name + "')\n";
  if (!values.empty()) out += "      case $before in\n" + values + "      esac\n";
  out += "      options='" + options + "'\n";
  std::string arguments;
  for (const CLI::Option* option : positionals_of(app)) {
    if (arguments.empty()) arguments = bash_value(*option, sources);  // the first stands for all: the others are numbers
  }
  if (!arguments.empty()) out += "      [[ $word == -* ]] || { " + arguments + "; return; }\n";
  return out + "      ;;\n";
}

// In single quotes, and with what _arguments gives a meaning made harmless.
std::string zsh_text(const std::string& text, bool in_brackets) {
  std::string out;
  for (const char c : text) {
    if (c == '\'')
      out += "'\\''";
    else if (c == ':' || (in_brackets && (c == '[' || c == ']')) || c == '\\')
      out += std::string("\\") + c;
    else
      out += c;
  }
  return out;
}

std::string zsh_value(const CLI::Option& option, const WordSources& sources) {
  const WordSource source = source_of(option, sources);
  const std::string name = option.get_positional() ? option.get_name(true) : value_name(option);
  std::string action = is_number(option) ? " " : "_files";
  const std::vector<std::string> words = words_of(option);
  if (!words.empty()) {
    action = "(";
    for (const std::string& word : words) action += (action.size() > 1 ? " " : "") + word;
    action += ")";
  } else if (!source.command.empty()) {
    const bool key = option.get_lnames().size() == 1 && option.get_lnames().front() == "set";
    action = std::string("{compadd ") + (key ? "-S \"\" " : "") + "-- ${(f)\"$(" + zsh_text(source.command, false) + ")\"}";
    action += source.or_file ? "; _files}" : "}";
  }
  return ":" + zsh_text(name, false) + ":" + action;
}

std::string zsh_arguments(const CLI::App& app, const WordSources& sources, const std::string& indent) {
  std::string out;
  for (const CLI::Option* option : offered_of(app)) {
    const std::string name = "--" + option->get_lnames().front();
    out += " \\\n" + indent + "'" + (may_repeat(*option) ? "*" : "") + name + "[" + zsh_text(option->get_description(), true) + "]" +
           (takes_value(*option) ? zsh_value(*option, sources) : "") + "'";
  }
  int place = 0;
  for (const CLI::Option* option : positionals_of(app)) {
    ++place;
    out += " \\\n" + indent + "'" + (may_repeat(*option) ? "*" : std::to_string(place)) + zsh_value(*option, sources) + "'";
  }
  return out;
}

}  // namespace

std::string bash_completion(const CLI::App& app, const WordSources& sources) {
  const std::string& program = app.get_name();
  const std::string function = "_" + program;
  const std::vector<const CLI::App*> commands = commands_of(app);
  std::string with_value;  // options of the program, whose value is no command
  for (const CLI::Option* option : options_of(app)) {
    if (takes_value(*option)) with_value += (with_value.empty() ? "--" : "|--") + option->get_lnames().front();
  }
  std::string out =
      "# Completion of " + program + " for bash, printed by `" + program + " completion bash`: do not edit.\n" + function +
      "() {\n  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command= options= i\n  COMPREPLY=()\n"
      "  for ((i = 1; i < COMP_CWORD; i++)); do\n    case ${COMP_WORDS[i]} in\n";
  if (!with_value.empty()) out += "      " + with_value + ") ((++i)) ;;\n";
  out += "      " + names_of(commands, "|") + ") command=${COMP_WORDS[i]}; break ;;\n    esac\n  done\n  case $command in\n";
  out += bash_case(app, "", sources);
  for (const CLI::App* command : commands) out += bash_case(*command, command->get_name(), sources);
  out += "  esac\n  [ -n \"$command\" ] || options+=' " + names_of(commands, " ") +
         "'\n  COMPREPLY=($(compgen -W \"$options\" -- \"$word\"))\n}\ncomplete -F " + function + " " + program + "\n";
  return out;
}

std::string zsh_completion(const CLI::App& app, const WordSources& sources) {
  const std::string& program = app.get_name();
  std::string out = "#compdef " + program + "\n# Completion of " + program + " for zsh, printed by `" + program +
                    " completion zsh`: do not edit.\n_" + program +
                    "() {\n  local curcontext=$curcontext state line\n  local -a commands\n  commands=(\n";
  for (const CLI::App* command : commands_of(app))
    out += "    '" + command->get_name() + ":" + zsh_text(command->get_description(), false) + "'\n";
  out += "  )\n  _arguments -C" + zsh_arguments(app, sources, "    ") + " \\\n    '1:command:->command' '*::argument:->rest'\n";
  out += "  case $state in\n    command) _describe command commands ;;\n    rest)\n      case $words[1] in\n";
  for (const CLI::App* command : commands_of(app))
    out += "        " + command->get_name() + ") _arguments" + zsh_arguments(*command, sources, "          ") + " ;;\n";
  return out + "      esac\n      ;;\n  esac\n}\n_" + program + " \"$@\"\n";
}

}  // namespace lf::command_line
