#include <gtest/gtest.h>

#include <algorithm>

#include "host_sim/app/fault_suite.hpp"
#include "host_sim/app/range_suite.hpp"

namespace lf::app {
namespace {

using campaign::TestCase;
using campaign::TestSuite;
using End = TestCase::End;

const TestCase& case_of(const TestSuite& suite, const std::string& name) {
  return *std::find_if(suite.cases.begin(), suite.cases.end(), [&](const TestCase& each) { return each.name == name; });
}

RowResult row(const std::string& name) {
  RowResult row;
  row.row = name;
  row.kind = "overcurrent";
  row.end = "stopped";
  return row;
}

TEST(CampaignSuites, AFaultRowFailsAsItFailsTheCampaign) {
  RowResult unsafe = row("unsafe"), unclear = row("unclear"), lied = row("lied"), goes_on = row("goes on"), safe = row("safe");
  unsafe.wrong = {"it moved", "with power"};
  unclear.unclear = {"its end does not say what happened"};
  lied.false_success = true;
  goes_on.must_go_on = true;
  goes_on.unclear = {"it did not go on"};
  FaultTable table;
  table.must_go_on = 20;
  table.went_on = 19;
  const TestSuite suite = fault_suite("default", {unsafe, unclear, lied, goes_on, safe}, table, {"not yet"});
  ASSERT_EQ(suite.cases.size(), 7u);
  EXPECT_EQ(case_of(suite, "unsafe").end, End::failed);
  EXPECT_EQ(case_of(suite, "unsafe").message, "it moved; with power (stopped)");
  EXPECT_EQ(case_of(suite, "unclear").kind, "unclear");
  EXPECT_EQ(case_of(suite, "lied").kind, "false success");
  EXPECT_EQ(case_of(suite, "goes on").end, End::passed);
  EXPECT_EQ(case_of(suite, "safe").end, End::passed);
  EXPECT_EQ(case_of(suite, "safe").group, "default faults: overcurrent");
  EXPECT_EQ(case_of(suite, "not yet").end, End::skipped);
  EXPECT_EQ(suite.cases.back().end, End::passed);
  table.went_on = 18;
  EXPECT_EQ(fault_suite("default", {safe}, table, {}).cases.back().end, End::failed);
  EXPECT_EQ(fault_suite("default", {safe}, FaultTable{}, {}).cases.size(), 1u);
}

TEST(CampaignSuites, ARangeRowFailsWhenItIsUnsafeOrUnnamed) {
  std::vector<RangeResult> results{
      {"a 1", "a", "a=1", "unsafe", "it moved"}, {"a 2", "a", "a=2", "unnamed", "why"}, {"b 1", "b", "b=1", "refused", "too large"}};
  for (int i = 0; i < 12; ++i) results.push_back({"c " + std::to_string(i), "c", "c=0", "success", ""});
  results.push_back({"many 1", "many", "d=1 e=2", "safe", "boot: d"});
  const TestSuite suite = range_suite("default", results, {"c 99"});
  ASSERT_EQ(suite.cases.size(), 18u);
  EXPECT_EQ(case_of(suite, "a 1: a=1").end, End::failed);
  EXPECT_EQ(case_of(suite, "a 2: a=2").kind, "unnamed");
  EXPECT_EQ(case_of(suite, "b 1: b=1").end, End::skipped);
  EXPECT_EQ(case_of(suite, "b 1: b=1").message, "refused: too large");
  EXPECT_EQ(case_of(suite, "many 1: d=1 e=2").end, End::passed);
  EXPECT_EQ(case_of(suite, "c 99").end, End::skipped);
  EXPECT_EQ(suite.cases.back().message, "12 of 15 succeeded");  // 80 %
  EXPECT_EQ(suite.cases.back().end, End::passed);
  results.push_back({"c 12", "c", "c=0", "safe", "c"});
  EXPECT_EQ(range_suite("default", results, {}).cases.back().end, End::failed);
}

}  // namespace
}  // namespace lf::app
