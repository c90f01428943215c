#include "host_sim/campaign/junit.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <map>
#include <string>

#include "tests/unit/campaign/made_up.hpp"

namespace lf::campaign {
namespace {

using tinyxml2::XMLElement;

// What continuous integration would read of it.
struct Read {
  explicit Read(const std::string& xml) {
    EXPECT_EQ(document.Parse(xml.c_str(), xml.size()), tinyxml2::XML_SUCCESS) << document.ErrorStr() << "\n" << xml;
    suite = document.FirstChildElement("testsuites") == nullptr ? nullptr
                                                                : document.FirstChildElement("testsuites")->FirstChildElement("testsuite");
    if (suite == nullptr) return;
    for (const XMLElement* each = suite->FirstChildElement("testcase"); each != nullptr; each = each->NextSiblingElement("testcase"))
      cases[std::string(each->Attribute("classname")) + " / " + each->Attribute("name")] = each;
  }
  tinyxml2::XMLDocument document;
  const XMLElement* suite = nullptr;
  std::map<std::string, const XMLElement*> cases;
};

TEST(Junit, HasACaseARunWithTheCauseOfItsFailure) {
  Campaign campaign = test::campaign(4);
  std::vector<RunSummary>& runs = campaign.cells[0].runs;
  runs[1] = test::failed(2, "turn", "the jaw's \"grip\" is <lost> & gone");
  runs[1].false_success = true;
  runs[2] = test::failed(3, "start", "ended by signal 11");
  runs[2].digest.clear();
  campaign.cells[0].not_flown = {5, 6};
  runs[3].as_expected = "drive fault: elbow";
  const Read read(junit_xml(suite_of(campaign)));
  ASSERT_NE(read.suite, nullptr);
  EXPECT_STREQ(read.suite->Attribute("name"), "default");
  EXPECT_EQ(read.suite->IntAttribute("tests"), 6);
  EXPECT_EQ(read.suite->IntAttribute("failures"), 1);
  EXPECT_EQ(read.suite->IntAttribute("errors"), 1);
  EXPECT_EQ(read.suite->IntAttribute("skipped"), 2);
  EXPECT_EQ(read.suite->DoubleAttribute("time"), 10);
  EXPECT_STREQ(read.suite->Attribute("timestamp"), "2026-11-24T21:35:00");
  ASSERT_EQ(read.cases.size(), 6u);
  EXPECT_TRUE(read.cases.at("default / seed 1")->NoChildren());
  const XMLElement* failure = read.cases.at("default / seed 2")->FirstChildElement("failure");
  ASSERT_NE(failure, nullptr);
  EXPECT_STREQ(failure->Attribute("type"), "turn");
  EXPECT_STREQ(failure->Attribute("message"), "FALSE SUCCESS: the jaw's \"grip\" is <lost> & gone");
  EXPECT_NE(read.cases.at("default / seed 3")->FirstChildElement("error"), nullptr);
  EXPECT_NE(read.cases.at("default / seed 5")->FirstChildElement("skipped"), nullptr);
  EXPECT_STREQ(read.cases.at("default / seed 4")->FirstChildElement("system-out")->GetText(), "it failed as expected: drive fault: elbow");
}

TEST(Junit, OfAGridEachCellIsAGroup) {
  const Read read(junit_xml(suite_of(test::grid())));
  EXPECT_EQ(read.cases.count("default: valve.friction_nm=1 / seed 1"), 1u);
  EXPECT_EQ(read.cases.count("default: valve.friction_nm=2 / seed 4"), 1u);
}

// A reason may hold what a crashing program wrote.
TEST(Junit, AnyBytesMakeAReadableFile) {
  Campaign campaign = test::campaign(1);
  std::string bytes;
  for (int c = 0; c < 256; ++c) bytes += static_cast<char>(c);
  campaign.cells[0].runs[0] = test::failed(1, "start", bytes);
  campaign.command = bytes;
  const std::string xml = junit_xml(suite_of(campaign));
  const Read read(xml);
  EXPECT_EQ(read.cases.size(), 1u);
  for (const char c : xml) EXPECT_FALSE(static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') << int(c);
}

}  // namespace
}  // namespace lf::campaign
