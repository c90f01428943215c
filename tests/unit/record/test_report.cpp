#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host_sim/record/report.hpp"
#include "tests/unit/record/demo_run.hpp"

namespace lf::record {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::string without(std::string html, const std::string& element) {
  const std::string close = "</" + element + ">";
  for (std::size_t at = html.find("<" + element); at != html.npos; at = html.find("<" + element)) {
    const std::size_t end = html.find(close, at);
    if (end == html.npos) return html;
    html.erase(at, end + close.size() - at);
  }
  return html;
}

// Tags open and close in pairs; void elements and SVG's closed shapes aside. Empty when they do.
std::string first_unbalanced_tag(const std::string& page) {
  const std::string html = without(without(page, "script"), "style");
  std::vector<std::string> open;
  for (std::size_t at = html.find('<'); at != html.npos; at = html.find('<', at + 1)) {
    const std::size_t end = html.find('>', at);
    if (end == html.npos) return "no > after " + html.substr(at, 30);
    const std::string tag = html.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(tag[0] == '/', tag.find(' ') - (tag[0] == '/'));
    if (name == "img" || name == "input" || name == "meta" || tag[0] == '!' || tag.back() == '/') continue;
    if (tag[0] != '/') {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return "<" + tag + ">";
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : "<" + open.back() + ">";
}

ReportData small_run() {
  ReportData data = test::demo_run();
  data.pictures.resize(1);
  data.cloud.resize(500);
  return data;
}

TEST(Report, NamesCountersThatAreZeroInOneRow) {
  const std::string html = report_html(small_run());
  EXPECT_THAT(html, HasSubstr("refused inputs: peaks_ambiguous"));
  EXPECT_THAT(html, Not(HasSubstr("refused inputs: images_unexpected")));
  EXPECT_THAT(html, HasSubstr("can_unknown_node, images_unexpected"));
}

TEST(Report, OfSeveralValvesNamesEach) {
  ReportData data = small_run();
  for (TaskRecord& task : data.result.tasks) {
    if (task.task == "turn_valve") task.valve = "V<2>";
  }
  data.errors = report_errors(data.result, 0.42);
  const std::string html = report_html(data);
  for (const char* text : {"valve V&lt;2&gt; turned to (target", "turn valve V&lt;2&gt;", "valve V&lt;2&gt;&#39;s final angle"})
    EXPECT_THAT(html, HasSubstr(text));
  EXPECT_THAT(html, Not(HasSubstr("V<2>")));
}

TEST(Report, OfAValveThatNobodyTurnedSaysWhereItStands) {
  ReportData data = small_run();
  for (TaskRecord& task : data.result.tasks) task.done = false;
  const std::string html = report_html(data);
  EXPECT_THAT(html, HasSubstr("valve stands at, not turned to its target"));
  EXPECT_THAT(html, Not(HasSubstr("valve turned to")));
  for (const ReportError& error : report_errors(data.result, 0.8)) EXPECT_THAT(error.name, Not(HasSubstr("valve's final angle")));
}

TEST(Report, RefersToNothingOutsideOfItself) {
  const std::string html = report_html(small_run());
  for (const char* reference : {"http://", "src=\"/", "url(", "@import", "<link", "fetch(", "XMLHttpRequest"}) {
    EXPECT_THAT(html, Not(HasSubstr(reference)));
  }
  EXPECT_EQ(count_of(html, "https://"), 1u);
  EXPECT_THAT(html, HasSubstr("/*! https://github.com/leeoniya/uPlot")) << "a comment: where the library is from";
  EXPECT_THAT(html, HasSubstr("Content-Security-Policy\" content=\"default-src 'none'; img-src data:;")) << "held by the browser, too";
}

TEST(Report, CarriesTheLicenceOfTheLibraryInIt) {
  const std::string html = report_html(small_run());
  EXPECT_THAT(html, HasSubstr("Copyright (c) 2022 Leon Sorokin"));
  EXPECT_THAT(html, HasSubstr("The above copyright notice and this permission notice shall be included in"));
}

TEST(Report, ShowsTheVerdictTheCommandAndEveryPhaseWithoutScripts) {
  const ReportData data = small_run();
  const std::string html = report_html(data);
  const std::string without_scripts = without(html, "script");
  EXPECT_THAT(without_scripts, HasSubstr("<span class=\"verdict\">done</span>"));
  EXPECT_THAT(without_scripts, HasSubstr(data.command));
  for (const PhaseRecord& phase : data.result.phases) EXPECT_THAT(without_scripts, HasSubstr(">" + phase.name + "</text>"));
  EXPECT_EQ(count_of(without_scripts, "data:image/jpeg;base64,"), 1u);  // the picture
  EXPECT_EQ(count_of(without_scripts, "data:image/png;base64,"), 1u);   // the cloud
  EXPECT_EQ(count_of(without_scripts, "<svg class=\"drawing\""), 1 + data.charts.size()) << "the phases, and each chart";
  EXPECT_THAT(without_scripts, HasSubstr("66812 of 71000"));
}

TEST(Report, ShowsTheRobotWhereThereIsNoCloudAndTheCloudWhereThereIsNoRobot) {
  ReportData data = small_run();
  data.cloud.clear();
  const std::string robot = report_html(data);
  EXPECT_THAT(robot, HasSubstr("id=\"tool-place\""));
  EXPECT_THAT(robot, Not(HasSubstr("data-show=\"cloud\"")));
  EXPECT_THAT(robot, Not(HasSubstr("id=\"points\"")));
  EXPECT_EQ(first_unbalanced_tag(robot), "");
  data = small_run();
  data.motion = {};
  const std::string cloud = report_html(data);
  EXPECT_THAT(cloud, HasSubstr("id=\"points\""));
  EXPECT_THAT(cloud, Not(HasSubstr("id=\"tool-place\"")));
  EXPECT_EQ(first_unbalanced_tag(cloud), "");
  EXPECT_THAT(robot, HasSubstr("<canvas"));
  EXPECT_THAT(cloud, HasSubstr("<canvas"));
}

TEST(Report, OpensAndClosesItsElementsInPairs) { EXPECT_EQ(first_unbalanced_tag(report_html(small_run())), ""); }

TEST(Report, EscapesAllText) {
  ReportData data = small_run();
  const std::string attack = "<script>alert(\"1\")</script>&'";
  data.result.scenario = data.result.version = data.command = data.result.digest = data.result.host.isa = attack;
  data.result.success = false;
  data.result.failure = FailureRecord{attack, attack};
  data.result.phases[0].name = data.result.phases[0].outcome = attack;
  data.result.tasks[0].task = data.result.tasks[1].button = attack;
  data.result.core.rejected_inputs[attack] = 1;
  data.conditions[0] = {attack, attack};
  data.errors[0].name = data.errors[0].unit = attack;
  data.pictures[0].title = data.pictures[0].caption = attack;
  data.charts[0].title = data.charts[0].unit = data.charts[0].series[0].name = attack;
  data.notes = {attack};
  const std::string html = report_html(data);
  EXPECT_THAT(html, Not(HasSubstr("alert(\"")));
  EXPECT_GE(count_of(html, "&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt;&amp;&#39;"), 20u);
  EXPECT_EQ(first_unbalanced_tag(html), "");
}

TEST(Report, OfARunThatFailedAtOnceSaysSoAndIsWhole) {
  ReportData data;
  data.result.scenario = "default";
  data.result.failure = FailureRecord{"boot", "node 3 does not answer"};
  data.charts = {{"Joint positions", "rad", {}}};
  const std::string html = report_html(data);
  EXPECT_THAT(html, HasSubstr("<span class=\"verdict\">failed</span>"));
  EXPECT_THAT(html, HasSubstr("node 3 does not answer"));
  EXPECT_THAT(html, HasSubstr("nothing was recorded"));
  EXPECT_EQ(first_unbalanced_tag(html), "");
  EXPECT_THAT(html, Not(HasSubstr("nan")));
}

TEST(Report, ShowsFaultsWithTheirReactionsAndTimes) {
  ReportData data = small_run();
  data.result.faults = {{12.5, 12.75, 3, "scan", "image lost", "image lost <1>", "count"},
                        {13.25, 13.25, 1, "perceive", "panel vision unsure", "panel vision unsure: no panel seen", "retry"}};
  data.result.faults_left_out = 4;
  const std::string html = report_html(data);
  EXPECT_THAT(html, HasSubstr("12.500 s</td><td>scan</td><td>image lost &lt;1&gt;</td><td>count</td><td class=\"n\">3, to 12.750 s"));
  EXPECT_THAT(html,
              HasSubstr("13.250 s</td><td>perceive</td><td>panel vision unsure: no panel seen</td><td>retry</td><td class=\"n\">1</td>"));
  EXPECT_THAT(html, HasSubstr("And 4 more"));
  EXPECT_EQ(first_unbalanced_tag(html), "");
  // In every chart a flag: its line, and a bar to the last time.
  EXPECT_EQ(count_of(html, "<title>12.500 s: image lost &lt;1&gt;: count</title>"), data.charts.size());
  data.result.faults.clear();
  data.result.faults_left_out = 0;
  EXPECT_THAT(report_html(data), Not(HasSubstr("Faults and reactions")));
  EXPECT_THAT(report_html(data), Not(HasSubstr("<g class=\"fault\">")));
}

TEST(Report, SaysWhyARunFailedWhatToDoAndWhenItWas) {
  ReportData data = small_run();
  data.result.success = false;
  data.result.failure = FailureRecord{"perceive", "no panel", "the pictures are dark", "Raise the <exposure>.", "mean 2 grey"};
  data.result.provenance.date_utc = "2026-11-24T21:34:07Z";
  const std::string html = report_html(data);
  for (const char* words : {"the pictures are dark", "Raise the &lt;exposure&gt;.", "mean 2 grey", "2026-11-24T21:34:07Z",
                            "lanternfish run ./scenario.yaml --seed 7"})
    EXPECT_THAT(html, HasSubstr(words));
  EXPECT_EQ(first_unbalanced_tag(html), "");
}

TEST(Report, TellsTheBusLoadsApart) {
  const std::string html = report_html(small_run());
  EXPECT_THAT(html, HasSubstr("CAN bus load, stuff bits included"));
  EXPECT_THAT(html, HasSubstr("as sent / without stuff bits / with worst-case stuffing</td><td class=\"n\">34.9 / 33.4 / 36.3 %"));
}

TEST(Report, KeepsSpikesOfAMillionSamplesInAFewPoints) {
  ReportData data;
  ReportSeries series{"torque", {}, {}, false};
  for (int i = 0; i < 200'000; ++i) {
    series.t_s.push_back(i * 1e-3);
    series.value.push_back(i == 123'456 ? 1000 : 0);
  }
  data.charts = {{"Torque", "N m", {series}}};
  const std::string html = report_html(data);
  // Without the library and the page's own script, which are some 80 kB.
  EXPECT_LT(without(html, "script").size(), 60'000u);
  EXPECT_LT(html.size(), 300'000u);
  // The spike is drawn at the top: y of 1000 in a chart from 0 to 1050 and 210 to 10.
  EXPECT_THAT(html, HasSubstr(" 19.5"));
}

TEST(Report, DrawsATargetDashedInTheColourOfWhatWasReached) {
  ReportData data;
  const auto series = [](const char* name, bool dashed) { return ReportSeries{name, {0, 1}, {0, 1}, dashed}; };
  data.charts = {
      {"Joints", "rad", {series("slew", false), series("slew, target", true), series("elbow", false), series("elbow, target", true)}}};
  const std::string html = report_html(data);
  for (const char* path :
       {"<path class=\"series s0\"", "<path class=\"series s0 dashed\"", "<path class=\"series s1\"", "<path class=\"series s1 dashed\""}) {
    EXPECT_EQ(count_of(html, path), 1u) << path;
  }
}

// A chart of -2 to 3 has a margin of 5 % of that: 3 lies 5.25 / 5.5 of the way from 210 up to 10.
TEST(Report, DrawsASeriesLimitsInItsColourWithinTheChart) {
  ReportData data;
  ReportSeries bounded{"slew", {0, 1}, {0, 1}, false, {-2, 3}}, silent{"roll", {0, 1}, {unknown, unknown}, false, {-9, 9}};
  data.charts = {{"Joints", "rad", {bounded, silent}}};
  const std::string html = without(report_html(data), "script");
  EXPECT_THAT(html, HasSubstr("<title>slew: limit 3</title><line class=\"limit s0\" x1=\"64.0\" y1=\"19.1\" x2=\"1104.0\" y2=\"19.1\"/>"));
  EXPECT_THAT(html,
              HasSubstr("<title>slew: limit -2</title><line class=\"limit s0\" x1=\"64.0\" y1=\"200.9\" x2=\"1104.0\" y2=\"200.9\"/>"));
  EXPECT_THAT(html, HasSubstr("limits, each in its line's colour"));
  EXPECT_THAT(html, Not(HasSubstr("roll: limit"))) << "nothing was recorded that it could limit";
  data.charts[0].series[0].limits = {};
  EXPECT_THAT(without(report_html(data), "script"), Not(HasSubstr("limits, each")));
}

// Twelve pixels high, a digit of DejaVu Sans is 7.7 wide (0.636 em); letters are narrower on the mean.
TEST(Report, ATextBehindAPhasesBarEndsWithinTheDrawing) {
  for (const char* outcome : {"done", "failed", "interrupted by hand"}) {
    ReportData data;
    PhaseRecord first, last;
    first.name = "scan", first.start_s = 0, first.end_s = 100, first.outcome = "done";
    last.name = "turn the valve", last.start_s = 100, last.end_s = 1120.5, last.outcome = outcome;
    data.result.phases = {first, last};
    const std::string html = report_html(data);
    const std::string note = last.outcome == "done" ? "1020.5 s" : "1020.5 s, " + last.outcome;
    const std::size_t at = html.find(">" + note + "</text>");
    ASSERT_NE(at, html.npos) << note;
    const std::size_t x = html.rfind(" x=\"", at);
    EXPECT_LE(std::stod(html.substr(x + 4)) + 7.7 * static_cast<double>(note.size()), 1120) << note;
  }
}

TEST(Report, IsTheSameForTheSameData) { EXPECT_EQ(report_html(small_run()), report_html(small_run())); }

TEST(ReportErrors, AllowMoreInMurkyWater) {
  const RunResult result = test::demo_run().result;
  const auto aim = [&](double attenuation, const std::string& name) {
    for (const ReportError& error : report_errors(result, attenuation)) {
      if (error.name == name) return error.aim;
    }
    return unknown;
  };
  EXPECT_NEAR(aim(0.1, "stripe peaks, rms"), 0.1, 1e-12);
  EXPECT_NEAR(aim(0.8, "stripe peaks, rms"), 0.2, 1e-12);
}

}  // namespace
}  // namespace lf::record
