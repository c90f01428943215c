#include "host_sim/app/range_suite.hpp"

#include "host_sim/app/range_draws.hpp"

namespace lf::app {

namespace {

using campaign::TestCase;

TestCase case_of(const std::string& scenario, const RangeResult& result) {
  TestCase each;
  each.group = scenario + " ranges: " + result.key;
  each.name = result.name + ": " + result.set;
  each.message = result.reason;
  if (result.verdict == "refused") {
    each.end = TestCase::End::skipped;
    each.message = "refused: " + result.reason;
  } else if (result.verdict == "unsafe" || result.verdict == "unnamed") {
    each.end = TestCase::End::failed;
    each.kind = result.verdict;
  }
  return each;
}

}  // namespace

campaign::TestSuite range_suite(const std::string& scenario, const std::vector<RangeResult>& results,
                                const std::vector<std::string>& not_flown) {
  campaign::TestSuite suite;
  suite.name = scenario + " ranges";
  std::size_t singles = 0, successes = 0;
  for (const RangeResult& result : results) {
    suite.cases.push_back(case_of(scenario, result));
    const bool single = result.key != "many" && !is_of_an_end(result.name);
    singles += single ? 1 : 0;
    successes += single && result.verdict == "success" ? 1 : 0;
  }
  for (const std::string& name : not_flown)
    suite.cases.push_back({suite.name, name, TestCase::End::skipped, "", "not flown: its run was interrupted", record::unknown});
  if (singles == 0) return suite;
  TestCase share{suite.name, "80 % of the single draws succeed", TestCase::End::passed, "", "", record::unknown};
  share.message = std::to_string(successes) + " of " + std::to_string(singles) + " succeeded";
  if (static_cast<double>(successes) < single_share * static_cast<double>(singles)) {
    share.end = TestCase::End::failed;
    share.kind = "too few succeeded";
  }
  suite.cases.push_back(share);
  return suite;
}

}  // namespace lf::app
