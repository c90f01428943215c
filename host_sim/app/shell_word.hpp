// Commands that a reader can paste into a shell.
#pragma once

#include <string>

namespace lf::app {

// As it is, or in single quotes where a shell would read it otherwise.
std::string shell_word(const std::string& text);

}  // namespace lf::app
