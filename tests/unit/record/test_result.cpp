#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "host_sim/record/digest.hpp"
#include "host_sim/record/result.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/record/demo_run.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::record {
namespace {

using lf::test::message_of;
using testing::HasSubstr;

TEST(Result, HasTheKeysThatUsersScriptAgainst) {
  RunResult result = test::demo_run().result;
  result.docking = DockingRecord{1, 4, 0.5, 60};
  const auto json = nlohmann::json::parse(result_json(result));
  for (const char* key : {"scenario", "seed", "version", "provenance", "faults", "success", "failure", "drawn", "phases", "tasks", "errors",
                          "docking", "contact", "core", "bus", "host", "time", "digest"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  for (const char* key : {"plane_normal_deg", "plane_offset_mm", "valve_base_mm", "handle_angle_deg", "cloud_truth_median_mm",
                          "peak_rms_px", "peak_recall"}) {
    EXPECT_TRUE(json["errors"].contains(key)) << key;
  }
  EXPECT_EQ(json["drawn"], (nlohmann::json{{"valve_friction_nm", 1.5}, {"docking_shift_m", {0.004, -0.012, 0.019}}}));
  EXPECT_EQ(json["phases"][1], (nlohmann::json{{"name", "home"}, {"start_s", 1.2}, {"end_s", 4.3}, {"outcome", "done"}}));
  EXPECT_EQ(json["tasks"][0], (nlohmann::json{{"task", "turn_valve"}, {"target_deg", 90.0}, {"reached_deg", 89.1}, {"done", true}}));
  EXPECT_EQ(json["tasks"][1], (nlohmann::json{{"task", "press_button"}, {"button", "left"}, {"presses", 1}, {"done", true}}));
  EXPECT_EQ(json["core"]["tick_us"]["p999"], 21.5);
  EXPECT_TRUE(json["failure"].is_null());
}

TEST(Result, WritesNullForWhatIsNotAFiniteNumber) {
  RunResult result;
  result.time.wall_s = std::numeric_limits<double>::infinity();
  result.errors.cloud_truth_median_mm = -std::numeric_limits<double>::quiet_NaN();
  result.phases.push_back({"boot", 0, unknown, "failed"});
  const std::string text = result_json(result);
  const auto json = nlohmann::json::parse(text);
  EXPECT_TRUE(json["time"]["wall_s"].is_null());
  EXPECT_TRUE(json["errors"]["cloud_truth_median_mm"].is_null());
  EXPECT_TRUE(json["phases"][0]["end_s"].is_null());
  EXPECT_TRUE(json["core"]["heap_calls"].is_null());
  for (const char* not_json : {": nan", ": -nan"}) EXPECT_EQ(text.find(not_json), std::string::npos) << "a key may be called provenance";
  EXPECT_EQ(text.find("inf"), std::string::npos);
}

TEST(Result, ComesBackFromItsFileAsItWas) {
  RunResult result = test::demo_run().result;
  result.success = false;
  result.failure = FailureRecord{"grip", "the jaw closed on nothing: \"<held>\" \xFF"};
  result.failure->cause = "the pictures are dark";
  result.failure->remedy = "light them";
  result.failure->seen = "nothing";
  result.faults = {{12.5, 12.75, 3, "scan", "image lost", "image lost", "count"}, {13, 13, 1, "scan", "emcy", "node 3: hot", ""}};
  result.faults_left_out = 4;
  result.provenance = {"2026-11-24T21:34:07Z", "lanternfish run a --seed 7", {"a.b=1", "c=2"}, "a.yaml", "0123"};
  result.errors.peak_rms_px = unknown;
  result.calibration = CalibrationRecord{-0.31, 0.12, 0.2, unknown, -1.25, "the marker is too small", "survey it"};
  const std::string text = result_json(result);
  EXPECT_EQ(result_json(parse_result_json(text, "result.json")), text);
}

TEST(Result, TellsThreeBusLoadsApart) {
  const auto json = nlohmann::json::parse(result_json(test::demo_run().result));
  EXPECT_EQ(json["bus"]["load_unstuffed_percent"], 33.4);
  EXPECT_EQ(json["bus"]["load_percent"], 34.9);
  EXPECT_EQ(json["bus"]["load_worst_case_percent"], 36.3);
}

TEST(Result, RefusesTextThatIsNoResult) {
  for (const char* text :
       {"", "{", "[]", "{}", R"({"scenario":1,"seed":2,"success":true})", R"({"scenario":"a","seed":2,"success":true,"phases":[1]})"}) {
    EXPECT_THAT(message_of<InputError>([&] { parse_result_json(text, "r.json"); }), HasSubstr("r.json: is not a run's result")) << text;
  }
}

TEST(Percentiles, AreNearestRanks) {
  std::vector<double> values;
  for (int i = 1000; i >= 1; --i) values.push_back(i);
  const TimesRecord times = times_record(values);
  EXPECT_EQ(times.p50, 500);
  EXPECT_EQ(times.p99, 990);
  EXPECT_EQ(times.p999, 999);
  EXPECT_EQ(times.max, 1000);
  EXPECT_EQ(times_record({7}).p50, 7);
}

// FIPS 180-2, appendix B.1.
TEST(Digest, IsSha256) { EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"); }

TEST(Digest, TellsEveryDifferenceInARunAndNothingElse) {
  const auto digest = [](std::int64_t ns, std::uint8_t bus, CanDirection direction, CanFrame frame, std::string_view decision,
                         double state) {
    RunDigest run;
    run.can_frame(Time::from_ns(ns), bus, direction, frame);
    run.decision(Time::from_ns(ns), decision);
    run.state("q", state);
    return run.hex();
  };
  const CanFrame frame{0x181, 2, {1, 2}};
  const std::string first = digest(5, 0, CanDirection::to_core, frame, "grip", 0.0);
  EXPECT_EQ(first.size(), 64u);
  EXPECT_EQ(digest(5, 0, CanDirection::to_core, frame, "grip", -0.0), first);
  const std::set<std::string> others{first,
                                     digest(6, 0, CanDirection::to_core, frame, "grip", 0),
                                     digest(5, 1, CanDirection::to_core, frame, "grip", 0),
                                     digest(5, 0, CanDirection::to_devices, frame, "grip", 0),
                                     digest(5, 0, CanDirection::to_core, {0x182, 2, {1, 2}}, "grip", 0),
                                     digest(5, 0, CanDirection::to_core, {0x181, 3, {1, 2}}, "grip", 0),
                                     digest(5, 0, CanDirection::to_core, {0x181, 2, {1, 3}}, "grip", 0),
                                     digest(5, 0, CanDirection::to_core, frame, "grin", 0),
                                     digest(5, 0, CanDirection::to_core, frame, "grip", 1e-300)};
  EXPECT_EQ(others.size(), 9u);
}

TEST(Digest, DoesNotConfuseWhereOneTextEndsAndTheNextBegins) {
  RunDigest a, b;
  a.decision(Time(), "ab");
  a.decision(Time(), "c");
  b.decision(Time(), "a");
  b.decision(Time(), "bc");
  EXPECT_NE(a.hex(), b.hex());
}

}  // namespace
}  // namespace lf::record
