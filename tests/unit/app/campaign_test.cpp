// `lanternfish campaign --seeds` and `lanternfish compare`, from outside.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host_sim/record/experiment.hpp"
#include "tests/unit/app/program.hpp"

namespace lf::app {
namespace {

using Json = nlohmann::json;

// Missions that end at their time limit, before anything moves: short, all failed, all alike.
constexpr const char* short_scenario = "time_limit_s: 1\ntasks: [{turn_valve: {to_deg: 90}}]\n";

class Campaigns : public Program {
 protected:
  Json json_of(const std::string& path) const { return Json::parse(text_of(folder() / path)); }
  bool there(const std::string& path) const { return std::filesystem::exists(folder() / path); }
  static bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }
};

TEST_F(Campaigns, LeaveDataATableAPageAndTestCases) {
  file("my.yaml", short_scenario);
  const Said said = run("campaign ./my.yaml --seeds 1,3-4 --jobs 1 --out c");
  EXPECT_EQ(said.status, 1) << said.err;
  EXPECT_TRUE(has(said.err, "3 runs in c, 1 at a time\n0 of 3 runs\n")) << said.err;
  EXPECT_TRUE(has(said.out, "0 of 3 succeeded (95 %: 0.0 to 56.1 %), 0 false successes (0.0 to 56.1 %)")) << said.out;
  const Json campaign = json_of("c/campaign.json");
  EXPECT_EQ(campaign["runs"], 3);
  EXPECT_EQ(campaign["command"], "lanternfish campaign ./my.yaml --seeds 1,3-4");
  EXPECT_EQ(campaign["cells"][0]["results"][1]["seed"], 3);
  EXPECT_EQ(campaign["cells"][0]["results"][1]["folder"], "3");
  EXPECT_EQ(campaign["cells"][0]["experiment"]["scenario"], json_of("c/experiment.json")["scenario"]);
  ASSERT_EQ(campaign["causes"].size(), 1u);
  EXPECT_EQ(campaign["causes"][0]["runs"].size(), 3u);
  EXPECT_TRUE(has(text_of(folder() / "c/junit.xml"), "tests=\"3\" failures=\"3\" errors=\"0\" skipped=\"0\""));
  EXPECT_TRUE(has(text_of(folder() / "c/campaign.html"), "<a href=\"3/report.html\">seed 3</a>"));
  EXPECT_TRUE(there("c/3/report.html"));
  EXPECT_TRUE(there("c/campaign.csv"));
  EXPECT_TRUE(there("c/runs.csv"));

  // It goes on where it was; when it flew stays as it was told then.
  const Said again = run("campaign ./my.yaml --seeds 1,3-5 --jobs 1 --out c --json");
  EXPECT_TRUE(has(again.err, "4 runs in c, 1 at a time, 3 are kept\n0 of 1 run\n")) << again.err;
  EXPECT_TRUE(has(again.err, "seed 5 ")) << "with --json a run's end is told on stderr";
  EXPECT_EQ(Json::parse(again.out)["runs"], 4);
  EXPECT_EQ(json_of("c/campaign.json")["sittings"].size(), 2u);
  EXPECT_EQ(json_of("c/campaign.json")["sittings"][0], campaign["sittings"][0]);
}

// Command, date, program and scenario of results that are put together from many runs.
void expect_provenance(const Json& results, const std::filesystem::path& experiment, const std::string& command) {
  const Json& provenance = results["provenance"];
  EXPECT_EQ(provenance["command"], command);
  EXPECT_EQ(provenance["date_utc"].get<std::string>().size(), std::string("2026-11-24T21:34:07Z").size()) << provenance;
  EXPECT_FALSE(provenance["version"].get<std::string>().empty());
  EXPECT_TRUE(provenance["revision"].is_string());
  EXPECT_EQ(provenance["set"][0], "water.attenuation_per_m=0.2");
  EXPECT_EQ(provenance["experiment"], record::file_hash(experiment));
}

TEST_F(Campaigns, TablesOfFaultsAndOfRangesSayHowTheyCameAbout) {
  const std::string set = " --set water.attenuation_per_m=0.2";
  (void)run("campaign turn_only --faults --rows 'boot: estop' --out f" + set);
  expect_provenance(json_of("f/faults.json"), folder() / "f/experiment.json",
                    "lanternfish campaign turn_only --faults --rows 'boot: estop' --set 'water.attenuation_per_m=0.2'");
  (void)run("campaign turn_only --ranges --draws 1 --many 0 --kinds docking.x_m --shard 9999/10000 --out r" + set);
  expect_provenance(
      json_of("r/ranges.json"), folder() / "r/experiment.json",
      "lanternfish campaign turn_only --ranges --draws 1 --many 0 --kinds docking.x_m --set water.attenuation_per_m=0.2 --shard "
      "9999/10000");
}

// As a campaign that runs holds it.
TEST_F(Campaigns, AFolderThatAnotherCampaignWritesToIsRefused) {
  std::filesystem::create_directory(folder() / "c");
  const int other = ::open((folder() / "c").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(::flock(other, LOCK_EX | LOCK_NB), 0);
  file("my.yaml", short_scenario);
  for (const char* kind : {"--seeds 1", "--faults --rows 'boot: estop'", "--ranges --draws 1 --many 0"}) {
    const Said said = run(std::string("campaign ./my.yaml ") + kind + " --jobs 1 --out c");
    EXPECT_EQ(said.status, 2) << kind;
    EXPECT_TRUE(has(said.err, "another campaign is writing there")) << said.err;
    EXPECT_TRUE(std::filesystem::is_empty(folder() / "c")) << kind;
  }
  ::close(other);
  EXPECT_EQ(run("campaign ./my.yaml --seeds 1 --jobs 1 --out c").status, 1) << "it fails at its time limit";
}

TEST_F(Campaigns, SeedsThatAreNoneAreRefusedByName) {
  const Said said = run("campaign turn_only --seeds 1,2,9-7 --out c");
  EXPECT_EQ(said.status, 2);
  EXPECT_TRUE(has(said.err, "--seeds 9-7 in '1,2,9-7': the first is above the last")) << said.err;
  EXPECT_FALSE(there("c"));
}

TEST_F(Campaigns, AGridHasAFolderACellThatSaysWhatItIs) {
  file("my.yaml", short_scenario);
  const std::string arguments = "campaign ./my.yaml --seeds 1 --jobs 2 --out c --json --set valve.friction_nm=";
  const Json grid = Json::parse(run(arguments + "1,2").out);
  ASSERT_EQ(grid["cells"].size(), 2u);
  EXPECT_EQ(grid["grid"], Json::parse(R"(["valve.friction_nm"])"));
  for (const Json& cell : grid["cells"]) {
    const std::string place = "c/" + cell["folder"].get<std::string>() + "/1";
    EXPECT_TRUE(has(place, "valve.friction_nm=" + cell["choice"]["valve.friction_nm"].get<std::string>() + "-" +
                               cell["hash"].get<std::string>().substr(0, 8)))
        << place;
    Json experiment = json_of(place + "/experiment.json");
    EXPECT_EQ(experiment["seed"], "1");
    experiment.erase("seed");
    for (const auto& [name, value] : cell["experiment"].items()) EXPECT_EQ(experiment[name], value) << name;
  }
  const std::string csv = text_of(folder() / "c/campaign.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);

  // A grid may grow: what was flown is kept.
  const Said more = run(arguments + "1,2,3");
  EXPECT_TRUE(has(more.err, "3 runs in c, 2 at a time, 2 are kept")) << more.err;
  // Another experiment may not.
  EXPECT_TRUE(has(run(arguments + "1,2 --set time_limit_s=2").err, "holds another experiment")) << "another scenario";
  EXPECT_TRUE(has(run("campaign ./my.yaml --seeds 1 --out c").err, "holds another experiment")) << "no grid";
}

TEST_F(Campaigns, AGridsCellThatCannotBeFlownIsRefusedBeforeAnythingIs) {
  const Said said = run("campaign turn_only --seeds 1-3 --out c --set valve.friction_nm=1,-5");
  EXPECT_EQ(said.status, 2);
  EXPECT_TRUE(has(said.err, "the grid's cell valve.friction_nm=-5 cannot be flown:")) << said.err;
  EXPECT_TRUE(has(run("campaign turn_only --seeds 1-3 --out c --set valve.friction_nm=2,2.0").err, "are the same scenario"));
  EXPECT_TRUE(has(run("campaign turn_only --seeds 1-3 --out c --set valve.friction_nm=2,,3").err, "value 2 of the list is empty"));
  EXPECT_FALSE(there("c"));
}

TEST_F(Campaigns, AreComparedWithAnEarlierOne) {
  file("my.yaml", short_scenario);
  ASSERT_EQ(run("campaign ./my.yaml --seeds 1-2 --out a").status, 1);
  const Said same = run("campaign ./my.yaml --seeds 1-2 --out b --compare a");
  EXPECT_EQ(same.status, 0) << same.out << same.err;
  EXPECT_TRUE(has(same.out, "the runs of all common seeds are identical")) << same.out;
  EXPECT_EQ(json_of("b/campaign.json")["comparison"]["identical"], true);
  EXPECT_TRUE(has(text_of(folder() / "b/campaign.html"), "identical, bit by bit"));
  EXPECT_EQ(run("compare a b").status, 0);
  EXPECT_EQ(Json::parse(run("compare a/campaign.json b --json").out)["common_seeds"], 2);

  const Said itself = run("campaign ./my.yaml --seeds 1-2 --out a --compare a/campaign.json");
  EXPECT_EQ(itself.status, 2);
  EXPECT_TRUE(has(itself.err, "is the folder that this campaign writes to")) << itself.err;
  const Said other = run("campaign ./my.yaml --set time_limit_s=1.5 --seeds 1-2 --out d --compare a");
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(has(other.err, "time_limit_s was 1, is 1.5. If that is what is compared, add --across time_limit_s")) << other.err;
  EXPECT_FALSE(there("d")) << "it is refused before anything is flown";
  EXPECT_TRUE(has(run("compare a a/1").err, "it is the folder of one run"));
  EXPECT_TRUE(has(run("compare a none").err, "there is no such folder"));
  EXPECT_EQ(run("campaign ./my.yaml --faults --compare a").status, 2);

  // Two runs that differ tell nothing, and a script must not take that for an answer.
  const Said across = run("campaign ./my.yaml --set time_limit_s=1.5 --seeds 1-2 --out d --compare a --across time_limit_s");
  EXPECT_EQ(across.status, 1);
  EXPECT_TRUE(has(across.out, "note: time_limit_s was 1, is 1.5")) << across.out;
  EXPECT_TRUE(has(across.out, "doubtful: too few runs to tell a change from chance")) << across.out;
}

// The folder of one seed holds what another experiment left: that run is refused, and the others are flown.
TEST_F(Campaigns, ARunThatIsRefusedIsARowWithItsReason) {
  file("my.yaml", short_scenario);
  ASSERT_EQ(run("campaign ./my.yaml --seeds 1 --out c").status, 1);
  ASSERT_EQ(run("run ./my.yaml --set time_limit_s=1.5 --seed 2 --no-outside --out c/2").status, 1);
  const Said said = run("campaign ./my.yaml --seeds 1-3 --out c");
  EXPECT_EQ(said.status, 1);
  EXPECT_TRUE(has(said.out, "failed in start: refused: lanternfish: ")) << said.out;
  EXPECT_TRUE(has(said.out, "holds another experiment: time_limit_s was 1.5, is 1")) << said.out;
  EXPECT_EQ(json_of("c/campaign.json")["runs"], 3);
  EXPECT_TRUE(has(text_of(folder() / "c/junit.xml"), "failures=\"2\" errors=\"1\""));
  EXPECT_FALSE(has(text_of(folder() / "c/campaign.html"), "href=\"2/report.html\"")) << "a report of another experiment";
}

TEST_F(Campaigns, TellARunsPhasesOnlyToItsOwnUser) {
  file("my.yaml", short_scenario);
  const Said loud = run("run ./my.yaml --no-outside --out r");
  EXPECT_TRUE(has(loud.err, "boot")) << "without a terminal phases are told, too: " << loud.err;
  EXPECT_EQ(run("run ./my.yaml --no-outside --out r --quiet").err, "");
}

TEST_F(Campaigns, OfRangesLeaveTestCases) {
  const Said said = run("campaign default --ranges --draws 1 --many 0 --kinds valve.friction_nm --out m --json");
  const Json table = Json::parse(said.out);
  EXPECT_TRUE(
      has(text_of(folder() / "m/junit.xml"), "<testsuite name=\"default ranges\" tests=\"" + std::to_string(int(table["rows"]) + 1) + "\""))
      << said.err;
  EXPECT_TRUE(there("m/ranges.md"));
}

}  // namespace
}  // namespace lf::app
