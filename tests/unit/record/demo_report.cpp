// Writes the report of a made-up run, to look at: demo_report FILE.html
#include <cstdio>

#include "host_sim/record/file_sink.hpp"
#include "tests/unit/record/demo_run.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: demo_report FILE.html\n");
    return 2;
  }
  try {
    lf::record::write_file_atomically(argv[1], lf::record::report_html(lf::record::test::demo_run()));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
