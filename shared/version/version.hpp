// Which build this is.
#pragma once

#include <string>

namespace lf {

const char* version();     // "0.1.0"
const char* revision();    // git's description of the source, "unknown" outside a clone
const char* compiler();    // "GCC 12.2.0"
const char* build_type();  // "Release, x86-64-v3"

// "PROGRAM 0.1.0 (revision), compiler, build": what --version prints.
std::string version_line(const char* program);

}  // namespace lf
