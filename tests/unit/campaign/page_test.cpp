#include "host_sim/campaign/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host_sim/campaign/figures.hpp"
#include "tests/unit/campaign/made_up.hpp"

namespace lf::campaign {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// Tags open and close in pairs, but for void elements and SVG's closed shapes. Empty when they do.
std::string first_unbalanced_tag(std::string page) {
  const std::size_t style = page.find("<style>");
  page.erase(style, page.find("</style>") - style);
  page.erase(page.find("</style>"), 8);
  std::vector<std::string> open;
  for (std::size_t at = page.find('<'); at != std::string::npos; at = page.find('<', at + 1)) {
    const std::string tag = page.substr(at + 1, page.find('>', at) - at - 1);
    const bool closes = tag.starts_with('/');
    const std::string name = tag.substr(closes ? 1 : 0, tag.find(' ') - (closes ? 1 : 0));
    if (name == "meta" || name == "br" || tag.starts_with('!') || tag.ends_with('/')) continue;
    if (!closes) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return "<" + tag + ">";
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : "<" + open.back() + ">";
}

Campaign with_failures() {
  Campaign campaign = test::campaign(25);
  std::vector<RunSummary>& runs = campaign.cells[0].runs;
  runs[1] = test::failed(2, "turn", "turned by 3.2 deg only");
  runs[4] = test::failed(5, "turn", "turned by 4.1 deg only");
  runs[7] = test::failed(8, "start", "ended by signal 11");
  runs[7].folder.clear();
  runs[7].has_report = false;
  runs[7].figures.assign(figures().size(), record::unknown);
  return campaign;
}

// Text within a table but in none of its cells, which a browser would put elsewhere; empty when there is none.
std::string stray_text(const std::string& page) {
  for (const char* tag : {"</td>", "</th>", "</tr>", "<tr>", "<table>"}) {
    for (std::size_t at = page.find(tag); at != std::string::npos; at = page.find(tag, at + 1)) {
      if (page[at + std::string(tag).size()] != '<') return page.substr(at, 60);
    }
  }
  return "";
}

TEST(Page, IsWholeAndRefersToTheRunsReportsOnly) {
  for (const Campaign& campaign : {with_failures(), test::grid(), test::campaign(1)}) {
    const std::string page = page_html(campaign, nullptr);
    EXPECT_EQ(first_unbalanced_tag(page), "");
    EXPECT_EQ(stray_text(page), "");
    EXPECT_THAT(page, Not(HasSubstr("<script")));
    EXPECT_EQ(count_of(page, "src="), 0u);
    EXPECT_EQ(count_of(page, "http"), 0u);
    EXPECT_EQ(count_of(page, "url("), 0u);
    EXPECT_EQ(count_of(page, "href="), count_of(page, "/report.html\">"));
    EXPECT_THAT(page, Not(HasSubstr("nan")));
    EXPECT_THAT(page, Not(HasSubstr("inf\"")));
  }
}

TEST(Page, HasSharesWithIntervalsCausesAndProvenance) {
  const std::string page = page_html(with_failures(), nullptr);
  EXPECT_THAT(page, HasSubstr("<b>22 of 25</b>"));
  EXPECT_THAT(page, HasSubstr("<b>70.0 to 95.8 %</b>"));  // Wilson, 22 of 25
  EXPECT_THAT(page, HasSubstr("<b>0.0 to 13.3 %</b>"));   // 0 of 25
  EXPECT_THAT(page, HasSubstr("turned by … deg only<br><span class=\"soft\">such as: turned by 3.2 deg only"));
  EXPECT_THAT(page, HasSubstr("<a href=\"2/report.html\">seed 2</a>, <a href=\"5/report.html\">seed 5</a>"));
  EXPECT_THAT(page, HasSubstr("ended by signal 11"));
  EXPECT_THAT(page, Not(HasSubstr("href=\"/report.html\"")));
  EXPECT_THAT(page, HasSubstr("lanternfish campaign default --seeds 1-25"));
  EXPECT_THAT(page, HasSubstr("2026-11-24T21:35:00Z"));
  EXPECT_THAT(page, HasSubstr(record::hash_of(with_failures().cells[0].experiment)));
  EXPECT_THAT(page, HasSubstr("friction_nm: 2"));
}

// Each figure has a curve, and each run that has it a point.
TEST(Page, DrawsEachFigureOfEachRun) {
  const Campaign campaign = with_failures();
  const std::string page = page_html(campaign, nullptr);
  EXPECT_EQ(count_of(page, "<path class=\"curve"), figures().size());
  // 25 runs, one without figures; two of them failed before the valve was turned.
  EXPECT_EQ(count_of(page, "<circle"), 24 * figures().size() - 2);
  EXPECT_GT(count_of(page, "<rect class=\"histogram\""), 0u);
  EXPECT_EQ(count_of(page, ">95 %</text>"), figures().size());
}

// Runs that are all alike: the axis has a length, and its marks are told apart.
TEST(Page, AFigureThatIsTheSameInAllRunsHasAnAxis) {
  Campaign campaign = test::campaign(6);
  for (RunSummary& run : campaign.cells[0].runs) {
    run.figures.assign(figures().size(), 0);
    run.figures[0] = 42;
  }
  const std::string page = page_html(campaign, nullptr);
  EXPECT_THAT(page, Not(HasSubstr(">0.00000")));
  EXPECT_THAT(page, HasSubstr("y=\"208.0\">42.0</text>"));
}

TEST(Page, OfAGridHasARowACellAndACurveACell) {
  const std::string page = page_html(test::grid(), nullptr);
  EXPECT_THAT(page, HasSubstr("<h2>The grid</h2>"));
  EXPECT_EQ(count_of(page, "<svg class=\"share\""), 2u);
  EXPECT_EQ(count_of(page, "<path class=\"curve s1\""), figures().size());
  EXPECT_EQ(count_of(page, "<rect class=\"histogram\""), 0u);
}

TEST(Page, SaysWhatWasNotFlown) {
  Campaign campaign = test::campaign(2);
  campaign.cells[0].not_flown = {3, 4};
  EXPECT_THAT(page_html(campaign, nullptr), HasSubstr("interrupted: 2 runs were not flown"));
  campaign.cells[0].runs.clear();
  const std::string none = page_html(campaign, nullptr);
  EXPECT_EQ(first_unbalanced_tag(none), "");
  EXPECT_THAT(none, HasSubstr("<b>0 of 0</b>"));
}

TEST(Page, ShowsTheComparison) {
  const Campaign before = test::campaign(12);
  Campaign after = before;
  for (RunSummary& run : after.cells[0].runs) {
    run.digest += "'";
    run.figures[test::figure("plane_normal_deg")] += 0.001 * static_cast<double>(run.seed);
  }
  const Comparison comparison = compare(before, after, {}, "runs/<before>");
  const std::string page = page_html(after, &comparison);
  EXPECT_EQ(first_unbalanced_tag(page), "");
  EXPECT_EQ(stray_text(page), "");
  EXPECT_THAT(page, HasSubstr("runs/&lt;before&gt;"));
  EXPECT_THAT(page, HasSubstr("<span class=\"mark bad\">worse</span>"));
  EXPECT_THAT(page, HasSubstr("depends on the machine, not tested"));
  const std::string first = page.substr(page.find("<h2>Compared"), page.find("<details>") - page.find("<h2>Compared"));
  EXPECT_EQ(count_of(first, "plane_normal_deg"), 2u);
  EXPECT_EQ(count_of(first, "valve_base_mm"), 0u) << "what does not differ stands behind what does";
}

TEST(Page, TextOfOthersIsEscaped) {
  Campaign campaign = test::campaign(2);
  campaign.scenario = campaign.command = campaign.seeds = "<script>alert('x')</script>";
  campaign.cells[0].runs[0] = test::failed(1, "<b>", "\"><script>\xff");
  campaign.cells[0].experiment["scenario"] = "<script>";
  const std::string page = page_html(campaign, nullptr);
  EXPECT_EQ(first_unbalanced_tag(page), "");
  EXPECT_THAT(page, Not(HasSubstr("<script")));
}

}  // namespace
}  // namespace lf::campaign
