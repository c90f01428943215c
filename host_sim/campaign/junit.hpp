// JUnit XML, which continuous integration reads: one test case for each run or row of a campaign.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/campaign/campaign.hpp"

namespace lf::campaign {

struct TestCase {
  enum class End {
    passed,
    failed,   // it was flown, and came to what must not be
    error,    // it could not be flown: a crash, a refusal
    skipped,  // it was not flown
  };
  std::string group, name;
  End end = End::passed;
  std::string kind;     // of a failure: the phase, "unsafe"
  std::string message;  // why; may be empty when passed
  double wall_s = record::unknown;
};

struct TestSuite {
  std::string name, begun;                                      // UTC, as utc_text() has it
  std::vector<std::pair<std::string, std::string>> properties;  // command, version
  std::vector<TestCase> cases;
};

inline constexpr const char* junit_file = "junit.xml";

// Control characters become blanks, bytes that are not UTF-8 U+FFFD.
std::string junit_xml(const TestSuite& suite);

TestSuite suite_of(const Campaign& campaign);

}  // namespace lf::campaign
