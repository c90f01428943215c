// Which program this is.
#pragma once

namespace lf::app {

const char* version();     // "0.1.0"
const char* revision();    // git's description of the source, "unknown" outside a clone
const char* compiler();    // "GCC 12.2.0"
const char* build_type();  // "Release, x86-64-v3"

}  // namespace lf::app
