#include "host_sim/app/fault_table.hpp"

#include <gtest/gtest.h>

namespace lf::app {
namespace {

std::vector<RowResult> safe_rows(std::size_t count) {
  RowResult row;
  row.kind = "obstacle";
  row.step = "turn";
  return std::vector<RowResult>(count, row);
}

TEST(FaultTable, FailsForOneUnsafeUnclearOrLyingRow) {
  std::vector<RowResult> rows = safe_rows(400);
  EXPECT_TRUE(tabulate_faults(rows).good());
  rows[7].wrong = {"it moved"};
  EXPECT_FALSE(tabulate_faults(rows).good());
  rows[7].wrong.clear();
  rows[7].unclear = {"no cause is named"};
  EXPECT_FALSE(tabulate_faults(rows).good());
  rows[7].unclear.clear();
  rows[7].false_success = true;
  EXPECT_FALSE(tabulate_faults(rows).good());
}

// One in twenty may end all the same.
TEST(FaultTable, FailsWhereTooFewGoOn) {
  std::vector<RowResult> rows = safe_rows(40);
  for (RowResult& row : rows) row.must_go_on = row.went_on = true;
  rows[0].went_on = rows[1].went_on = false;
  EXPECT_TRUE(tabulate_faults(rows).good());
  rows[2].went_on = false;
  EXPECT_FALSE(tabulate_faults(rows).good());
}

// One in ten of those that may be, and two more: of 36 obstacles, 180 joints that seize and 130 jaws that hold the handle five, twenty and fifteen.
TEST(FaultTable, FailsWhereManyRowsAreExcused) {
  std::vector<RowResult> rows = safe_rows(5000);
  for (std::size_t i = 36; i < rows.size(); ++i) rows[i].kind = i < 216 ? "following" : "overcurrent";
  for (std::size_t i = 0; i < 5; ++i) rows[i].unfelt = true;
  for (std::size_t i = 36; i < 56; ++i) rows[i].stood_anyway = true;
  EXPECT_TRUE(tabulate_faults(rows).good());
  rows[5].unfelt = true;
  EXPECT_FALSE(tabulate_faults(rows).good());
  rows[5].unfelt = false;
  rows[56].stood_anyway = true;
  EXPECT_FALSE(tabulate_faults(rows).good());
  EXPECT_NE(markdown_of(tabulate_faults(rows), "").find("21 of 180 with a joint that seized"), std::string::npos);
  EXPECT_NE(markdown_of(tabulate_faults(rows), "").find("These are too many"), std::string::npos);
  rows[56].stood_anyway = false;
  for (std::size_t i = 300; i < 430; ++i) rows[i].gripped = true;
  for (std::size_t i = 300; i < 315; ++i) rows[i].gave_way = true;
  EXPECT_TRUE(tabulate_faults(rows).good());
  rows[315].gave_way = true;
  EXPECT_FALSE(tabulate_faults(rows).good());
}

}  // namespace
}  // namespace lf::app
