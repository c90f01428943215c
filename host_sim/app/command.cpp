#include "host_sim/app/command.hpp"

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace lf::app {

namespace {

// `| head` has read enough: that ends neither a run nor a campaign, whose exit status stays their own.
bool reader_gone = false;

void check_stdout() {
  if (reader_gone) return;
  // ferror: a text longer than the buffer fails before the flush, which then has nothing left to write.
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  reader_gone = errno == EPIPE;
  if (!reader_gone) throw EnvironmentError(std::string("standard output: ") + std::strerror(errno));
}

}  // namespace

void print_json(const Json& document) {
  const std::string text = document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  if (reader_gone) return;
  std::fwrite(text.data(), 1, text.size(), stdout);
  check_stdout();
}

void print(const char* format, ...) {
  if (reader_gone) return;
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
