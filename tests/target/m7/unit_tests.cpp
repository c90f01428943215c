// Runs the unit tests linked to it. Argument: the suite to run; without one, all. Exit status 1 when a check failed.
#include "tests/target/m7/gtest/gtest.h"
#include "toolchain/cortex_m7/stack_use.hpp"

int main() {
  using lf::m7::print, lf::m7::print_number;
  char suite[64];
  const bool one = lf::m7::argument(1, suite, sizeof suite);
  int tests = 0, failed = 0;
  for (const testing::Registration* test = testing::Registration::first(); test != nullptr; test = test->next) {
    if (one && std::strcmp(suite, test->suite) != 0) continue;
    const int before = testing::counters.failures;
    test->run();
    ++tests;
    if (testing::counters.failures == before) continue;
    ++failed;
    print("FAILED ");
    print(test->suite);
    print(".");
    print(test->name);
    print("\n");
  }
  print_number(tests);
  print(" tests, ");
  print_number(testing::counters.checks);
  print(" checks, ");
  print_number(failed);
  print(" tests failed; stack used: ");
  print_number(static_cast<double>(lf::m7::stack_used_bytes()));
  print(" bytes\n");
  return tests > 0 && failed == 0 ? 0 : 1;
}
