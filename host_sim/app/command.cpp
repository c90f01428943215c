#include "host_sim/app/command.hpp"

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace lf::app {

namespace {

void check_stdout() {
  // ferror: a text longer than the buffer fails before the flush, which then has nothing left to write.
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw EnvironmentError(std::string("standard output: ") + std::strerror(errno));
}

}  // namespace

void print_json(const Json& document) {
  const std::string text = document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  std::fwrite(text.data(), 1, text.size(), stdout);
  check_stdout();
}

void print(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::vprintf(format, arguments);
  va_end(arguments);
  check_stdout();
}

void tell_doubts(const std::string& file, const std::vector<std::string>& doubts) {
  for (const std::string& doubt : doubts) std::fprintf(stderr, "lanternfish: %s: doubtful: %s\n", file.c_str(), doubt.c_str());
}

std::string count_of(std::size_t n, const std::string& noun) {
  std::string text = std::to_string(n);
  text += " ";
  text += noun;
  if (n != 1) text += "s";
  return text;
}

}  // namespace lf::app
