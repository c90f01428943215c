#include "host_sim/campaign/campaign_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "host_sim/campaign/campaign_csv.hpp"
#include "host_sim/campaign/figures.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/campaign/made_up.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::campaign {
namespace {

using testing::HasSubstr;
using Json = nlohmann::ordered_json;

void put(const std::filesystem::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

std::string refusal_of(const std::filesystem::path& path) {
  try {
    (void)read_campaign(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Cells of a row; quotes hold commas, line ends and doubled quotes (RFC 4180).
std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows{{""}};
  bool quoted = false;
  for (std::size_t i = 0; i < csv.size(); ++i) {
    const char c = csv[i];
    if (quoted && c == '"' && i + 1 < csv.size() && csv[i + 1] == '"') {
      rows.back().back() += csv[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && c == ',') {
      rows.back().emplace_back();
    } else if (!quoted && c == '\n') {
      rows.push_back({""});
    } else {
      rows.back().back() += c;
    }
  }
  rows.pop_back();
  return rows;
}

Campaign mixed() {
  Campaign grid = test::grid();
  grid.cells[1].runs[1] = test::failed(2, "turn", "turned by 3.2 deg, \"not\" 90\nand more");
  grid.cells[1].runs[1].false_success = true;
  grid.cells[1].runs.pop_back();
  grid.cells[1].not_flown = {4};
  grid.cells[0].runs[0].as_expected = "estop";
  return grid;
}

TEST(CampaignFile, WhatIsWrittenIsReadAgain) {
  const lf::test::TemporaryFolder folder;
  const Campaign campaign = mixed();
  const std::string text = json_of(campaign).dump(2);
  put(folder.path() / campaign_file, text);
  const Campaign again = read_campaign(folder.path());
  EXPECT_EQ(json_of(again).dump(2), text);
  EXPECT_EQ(again.cells[1].runs[1].failure->reason, campaign.cells[1].runs[1].failure->reason);
  EXPECT_TRUE(std::isnan(again.cells[1].runs[1].figures[test::figure("valve_final_deg")]));
  EXPECT_EQ(json_of(read_campaign(folder.path() / campaign_file)).dump(2), text);  // the file itself
}

TEST(CampaignFile, HasSharesWithIntervalsCausesAndWhatMadeEachCell) {
  const Json json = json_of(mixed());
  EXPECT_EQ(json["runs"], 7);
  EXPECT_EQ(json["not_flown"], 1);
  EXPECT_EQ(json["successes"], 6);
  EXPECT_EQ(json["false_successes"], 1);
  EXPECT_LT(json["success_95"][1], 1.0);
  ASSERT_EQ(json["cells"].size(), 2u);
  EXPECT_EQ(json["cells"][1]["choice"]["valve.friction_nm"], "2");
  EXPECT_EQ(json["cells"][1]["success_95"].size(), 2u);
  EXPECT_EQ(json["cells"][1]["hash"].get<std::string>().size(), 64u);
  EXPECT_NE(json["cells"][0]["hash"], json["cells"][1]["hash"]);
  EXPECT_EQ(json["causes"][0]["cause"], "turned by … deg, \"not\" 90\nand more");
  EXPECT_EQ(json["causes"][0]["runs"][0]["seed"], 2);
  EXPECT_FALSE(json.contains("errors"));  // of different scenarios
  EXPECT_TRUE(json_of(test::campaign(2)).contains("errors"));
  EXPECT_EQ(json["sittings"][0]["begun"], "2026-11-24T21:35:00Z");
}

// A figure of a later version is not there in an earlier campaign.
TEST(CampaignFile, AFigureThatIsMissingIsUnknown) {
  const lf::test::TemporaryFolder folder;
  Json json = json_of(test::campaign(1));
  json["cells"][0]["results"][0]["figures"].erase("peak_recall");
  put(folder.path() / campaign_file, json.dump());
  EXPECT_TRUE(std::isnan(read_campaign(folder.path()).cells[0].runs[0].figures[test::figure("peak_recall")]));
}

TEST(CampaignFile, WhatIsNoCampaignIsRefusedWithWhatItIs) {
  const lf::test::TemporaryFolder folder;
  EXPECT_THAT(refusal_of(folder.path() / "none"), HasSubstr("there is no such folder"));
  EXPECT_THAT(refusal_of(folder.path()), HasSubstr("has no campaign.json: it is not a campaign's folder"));
  put(folder.path() / record::experiment_file, R"({"seed": "1"})");
  EXPECT_THAT(refusal_of(folder.path()), HasSubstr("the folder of one run"));
  put(folder.path() / record::experiment_file, R"({"campaign": "faults"})");
  EXPECT_THAT(refusal_of(folder.path()), HasSubstr("a campaign of faults, not of seeds"));
  put(folder.path() / record::experiment_file, R"({"campaign": "campaign"})");
  EXPECT_THAT(refusal_of(folder.path()), HasSubstr("Start it again: what is flown is kept"));
  for (const char* text : {"", "{", "[]", "7", "{\"format\": 1}", "{\"format\": \"x\"}"}) {
    put(folder.path() / campaign_file, text);
    EXPECT_THAT(refusal_of(folder.path()), HasSubstr("campaign.json: is not a campaign's: ")) << text;
  }
  put(folder.path() / campaign_file, "{\"format\": 2}");
  EXPECT_THAT(refusal_of(folder.path()), HasSubstr("its format is 2, which this version does not read"));
  Json json = json_of(test::campaign(1));
  json["cells"] = Json::array();
  put(folder.path() / campaign_file, json.dump());
  EXPECT_THAT(refusal_of(folder.path()), HasSubstr("it has no cell"));
  json = json_of(test::campaign(1));
  json["cells"][0]["results"][0]["figures"] = 3;
  put(folder.path() / campaign_file, json.dump());
  EXPECT_THAT(refusal_of(folder.path()), HasSubstr("is not a campaign's"));
}

TEST(CampaignCsv, HasARowACell) {
  const Campaign campaign = mixed();
  const auto rows = rows_of(cells_csv(campaign));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0][0], "valve.friction_nm");
  EXPECT_EQ(rows[1].size(), rows[0].size());
  EXPECT_EQ(rows[0].size(), 1 + 8 + 3 * figures().size() + 2);
  EXPECT_EQ(rows[2][0], "2");
  EXPECT_EQ(rows[2][1], "3");                        // runs
  EXPECT_EQ(rows[2][2], "1");                        // not flown
  EXPECT_EQ(rows[2][3], "2");                        // successes
  EXPECT_NEAR(std::stod(rows[2][4]), 0.2077, 5e-5);  // Wilson's interval of 2 of 3
  EXPECT_EQ(rows[2].back(), record::hash_of(campaign.cells[1].experiment));
}

TEST(CampaignCsv, HasARowARun) {
  const auto rows = rows_of(runs_csv(mixed()));
  ASSERT_EQ(rows.size(), 8u);
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  EXPECT_EQ(rows[6][0], "2");
  EXPECT_EQ(rows[6][1], "2");
  EXPECT_EQ(rows[0][7], "calibration_doubted");
  EXPECT_EQ(rows[6][7], "0");
  EXPECT_EQ(rows[6][5], "turned by 3.2 deg, \"not\" 90\nand more");
  EXPECT_EQ(rows[6][8 + test::figure("valve_final_deg")], "");
  EXPECT_EQ(std::stod(rows[6][8]), mixed().cells[1].runs[1].figures[0]);
}

}  // namespace
}  // namespace lf::campaign
