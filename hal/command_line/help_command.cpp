#include "hal/command_line/help_command.hpp"

#include <memory>
#include <vector>

#include "hal/command_line/tree.hpp"
#include "hal/config/nearest.hpp"
#include "shared/input_error.hpp"

namespace lf::command_line {

namespace {

const CLI::App& command_named(const CLI::App& app, const std::string& name) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands_of(app)) {
    if (command->get_name() == name) return *command;
    names.push_back(command->get_name());
  }
  const std::string near = config::suggestion(name, names);
  throw InputError("no command '" + name + "'" + (near.empty() ? "; `" + app.get_name() + " --help` lists them" : near));
}

std::string page_of(const ManPages& pages, const std::string& section) {
  const auto found = pages.find(section);
  if (found != pages.end()) return found->second();
  std::string list;
  for (const auto& [known, ignored] : pages) list += (list.empty() ? "" : ", ") + known;
  throw InputError("help --man: there is no page in section '" + section + "'; there are " + list);
}

}  // namespace

void add_help_commands(CLI::App& app, std::function<int()>& action, const ManPages& pages, const WordSources& sources,
                       const std::function<void(const std::string&)>& print) {
  struct Wanted {
    std::string command, section, shell;
  };
  auto wanted = std::make_shared<Wanted>();
  CLI::App* help = app.add_subcommand("help", "Explain a command: its arguments and options");
  help->add_option("COMMAND", wanted->command, "A command of the program; without one, the program itself");
  help->add_option("--man", wanted->section, "Print a page of the manual in man(7): its section")->group("");
  help->callback([&app, &action, pages, print, wanted] {
    action = [&app, pages, print, wanted] {
      // Whoever asks for a command's help has chosen `help`: CLI11 would print that one's.
      const CLI::App& explained = wanted->command.empty() ? app : command_named(app, wanted->command);
      print(!wanted->section.empty()  ? page_of(pages, wanted->section)
            : wanted->command.empty() ? app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal)
                                      : explained.help(app.get_name()));
      return 0;
    };
  });
  CLI::App* completion = app.add_subcommand("completion", "Print a script with which a shell completes this program's command lines");
  completion->add_option("SHELL", wanted->shell, "bash or zsh")->check(CLI::IsMember({"bash", "zsh"}))->required();
  completion->callback([&app, &action, sources, print, wanted] {
    action = [&app, sources, print, wanted] {
      WordSources all = sources;
      std::string& names = all["COMMAND"].command = "printf \"%s\\n\"";
      for (const CLI::App* command : commands_of(app)) names += " " + command->get_name();
      print(wanted->shell == "bash" ? bash_completion(app, all) : zsh_completion(app, all));
      return 0;
    };
  });
}

}  // namespace lf::command_line
