#include "host_sim/campaign/causes.hpp"

#include <gtest/gtest.h>

#include "tests/unit/campaign/made_up.hpp"

namespace lf::campaign {
namespace {

TEST(Causes, MeasuredNumbersAreNoPartOfACause) {
  EXPECT_EQ(cause_of("the valve stands at 18.3 deg, not 90"), "the valve stands at … deg, not 90");
  EXPECT_EQ(cause_of("pushed with 155 N"), "pushed with … N");
  EXPECT_EQ(cause_of("off by -3.25 mm after 12 s"), "off by … mm after … s");
  EXPECT_EQ(cause_of("turned by 3.1°"), "turned by …°");
}

TEST(Causes, CodesAndCountsAre) {
  for (const char* text : {"drive fault: elbow, EMCY 0x2310 (continuous over-current)", "panel vision unsure (7)", "bus 0 is off",
                           "ended by signal 11", "2 of 3 presses", "button 2 missing", "", "v1.2b"})
    EXPECT_EQ(cause_of(text), text);
}

TEST(Causes, TheLargestComesFirstAndFalseSuccessesBeforeAll) {
  Campaign campaign = test::campaign(8);
  std::vector<RunSummary>& runs = campaign.cells[0].runs;
  runs[1] = test::failed(2, "scan", "the laser is 3.5 mm off");
  runs[2] = test::failed(3, "boot", "no answer");
  runs[4] = test::failed(5, "scan", "the laser is 4.5 mm off");
  runs[6] = test::failed(7, "turn", "the valve stands at 3.2 deg");
  runs[6].false_success = true;
  const std::vector<Cause> causes = causes_of(campaign);
  ASSERT_EQ(causes.size(), 3u);
  EXPECT_TRUE(causes[0].false_success);
  EXPECT_EQ(causes[1].cause, "the laser is … mm off");
  EXPECT_EQ(causes[1].example, "the laser is 3.5 mm off");
  EXPECT_EQ(causes[1].runs, (std::vector<std::pair<std::size_t, std::size_t>>{{0, 1}, {0, 4}}));
  EXPECT_EQ(causes[2].phase, "boot");
}

}  // namespace
}  // namespace lf::campaign
