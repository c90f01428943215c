#include "hal/command_line/man_page.hpp"

#include <cctype>
#include <sstream>

#include "hal/command_line/tree.hpp"
#include "hal/config/key_text.hpp"

namespace lf::command_line {

namespace {

// A hyphen is typed as a minus: what a reader copies from the page is what the program takes.
std::string roff(const std::string& text) {
  std::string out;
  bool bold = false;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '`')
      out += (bold = !bold) ? "\\fB" : "\\fR";
    else
      out += c;
  }
  const bool request = !out.empty() && (out.front() == '.' || out.front() == '\'');
  return request ? "\\&" + out : out;
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

// A literal block is opened and closed where its lines begin and end.
std::string paragraphs(const std::string& text) {
  std::string out;
  std::istringstream lines(text);
  bool literal = false, gap = false;
  for (std::string line; std::getline(lines, line);) {
    const bool wanted = line.starts_with("  ");
    if (line.empty()) {
      gap = true;
      continue;
    }
    if (literal && !wanted) out += ".fi\n.RE\n";
    if (gap) out += ".PP\n";
    if (wanted && !literal) out += ".RS\n.nf\n";
    literal = wanted;
    gap = false;
    out += roff(wanted ? line.substr(2) : line) + "\n";
  }
  return literal ? out + ".fi\n.RE\n" : out;
}

std::string item(const std::string& term, const std::string& text) { return ".TP\n.B " + roff(term) + "\n" + paragraphs(text); }

std::string section(const ManSection& one) {
  std::string out = ".SH " + one.title + "\n" + (one.text.empty() ? "" : paragraphs(one.text));
  for (const ManSection::Item& each : one.items) out += item(each.term, each.text);
  return out;
}

std::string head(const Manual& manual) {
  return ".\\\" Printed by the program: do not edit.\n.TH " + upper(manual.name) + " " + manual.section + " \"\" \"lanternfish\" \"" +
         manual.kind + "\"\n.SH NAME\n" + roff(manual.name) + " \\- " + roff(manual.summary) + "\n";
}

std::string option_text(const CLI::Option& option) {
  std::string text = option.get_description();
  if (text.empty() || text.back() != '.') text += ".";
  if (option.get_required()) text += " Has to be given.";
  if (may_repeat(option) && !option.get_positional()) text += " May be given again.";
  if (takes_value(option) && !option.get_default_str().empty()) text += " Default: " + option.get_default_str() + ".";
  return text;
}

std::string items_of(const CLI::App& app) {
  std::string out;
  for (const CLI::Option* option : positionals_of(app)) out += item(label_of(*option), option_text(*option));
  for (const CLI::Option* option : options_of(app)) {
    if (option->get_lnames().front() != "help") out += item(label_of(*option), option_text(*option));
  }
  return out;
}

std::string key_item(const config::Key& key, bool with_default) {
  std::string text = key.doc + ". Takes " + config::type_name(key);
  if (key.min < key.max) text += ", " + config::number_text(key.min) + " to " + config::number_text(key.max);
  if (!key.unit.empty()) text += (key.min < key.max ? " " : ", in ") + key.unit;
  text += ".";
  if (with_default) text += " Default: " + config::value_text(key) + ".";
  text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return item(key.path, text);
}

}  // namespace

std::string man_page(const Manual& manual, const CLI::App& app) {
  std::string out = head(manual) + ".SH SYNOPSIS\n.B " + roff(manual.name) + "\n[OPTION]... [COMMAND [ARGUMENT]...]\n";
  for (const ManSection& one : manual.before) out += section(one);
  out += ".SH OPTIONS\n" + items_of(app);
  out += item("--help", "Of the program, and behind a command of that one: its arguments and options.");
  out += ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(app)) {
    std::string does = command->get_description();
    does.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(does.front())));
    out += ".SS " + roff(synopsis_of(*command)) + "\n" + paragraphs(does + ".") + items_of(*command);
  }
  for (const ManSection& one : manual.after) out += section(one);
  return out;
}

std::string man_page(const Manual& manual, const config::Keys& keys, const std::vector<std::pair<std::string, config::Keys>>& inner) {
  std::string out = head(manual);
  for (const ManSection& one : manual.before) out += section(one);
  out += ".SH KEYS\n";
  for (const config::Key& key : keys) out += key_item(key, true);
  for (const auto& [title, table] : inner) {
    out += ".SH " + title + "\n";
    for (const config::Key& key : table) out += key_item(key, false);
  }
  for (const ManSection& one : manual.after) out += section(one);
  return out;
}

}  // namespace lf::command_line
