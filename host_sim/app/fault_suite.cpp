#include "host_sim/app/fault_suite.hpp"

#include "hal/config/joined.hpp"

namespace lf::app {

namespace {

using campaign::TestCase;

TestCase case_of(const std::string& scenario, const RowResult& row) {
  TestCase each;
  each.group = scenario + " faults: " + row.kind;
  each.name = row.row;
  each.message = row.reason.empty() ? row.end : row.end + ": " + row.reason;
  if (!row.safe()) {
    each.end = TestCase::End::failed;
    each.kind = row.false_success ? "false success" : "unsafe";
    each.message = config::joined(row.wrong, "; ") + " (" + each.message + ")";
  } else if (!row.unclear.empty() && !row.must_go_on) {
    each.end = TestCase::End::failed;
    each.kind = "unclear";
    each.message = config::joined(row.unclear, "; ") + " (" + each.message + ")";
  }
  return each;
}

}  // namespace

campaign::TestSuite fault_suite(const std::string& scenario, const std::vector<RowResult>& rows, const FaultTable& table,
                                const std::vector<std::string>& not_flown) {
  campaign::TestSuite suite;
  suite.name = scenario + " faults";
  for (const RowResult& row : rows) suite.cases.push_back(case_of(scenario, row));
  for (const std::string& name : not_flown)
    suite.cases.push_back({suite.name, name, TestCase::End::skipped, "", "not flown: the campaign was interrupted", record::unknown});
  if (table.pushed + table.seized + table.gripped > 0) {
    TestCase excused{suite.name, "few rows are excused", TestCase::End::passed, "", "", record::unknown};
    excused.message = std::to_string(table.unfelt) + " of " + std::to_string(table.pushed) + " pushed rows, " +
                      std::to_string(table.stood_anyway) + " of " + std::to_string(table.seized) + " with a joint that seized, " +
                      std::to_string(table.gave_way) + " of " + std::to_string(table.gripped) + " with the handle in a jaw without power";
    if (!table.few_excused()) {
      excused.end = TestCase::End::failed;
      excused.kind = "too many are excused";
    }
    suite.cases.push_back(excused);
  }
  if (table.must_go_on == 0) return suite;
  TestCase share{suite.name, "95 % of the rows that must go on do", TestCase::End::passed, "", "", record::unknown};
  share.message = std::to_string(table.went_on) + " of " + std::to_string(table.must_go_on) + " went on";
  if (static_cast<double>(table.went_on) < go_on_share * static_cast<double>(table.must_go_on)) {
    share.end = TestCase::End::failed;
    share.kind = "too few went on";
  }
  suite.cases.push_back(share);
  return suite;
}

}  // namespace lf::app
