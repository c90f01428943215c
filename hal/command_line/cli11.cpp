// CLI11's formatter and configuration reader. Every file that includes them compiles both in full, some seconds each; here it is done once for all that
// include <CLI/App.hpp>.
#include <CLI/CLI.hpp>
