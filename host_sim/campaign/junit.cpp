#include "host_sim/campaign/junit.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/record/report_parts.hpp"

namespace lf::campaign {
namespace {

using End = TestCase::End;
using record::escape_html;  // XML's five entities

// A line's end within an attribute reads as a blank unless it is written as a reference.
std::string attribute(const std::string& name, const std::string& value) {
  std::string text = escape_html(value);
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos;) text.replace(at, 1, "&#10;");
  return " " + name + "=\"" + text + "\"";
}

std::string seconds(double value) { return std::isfinite(value) ? record::formatted("%.3f", value) : "0"; }

std::string case_xml(const TestCase& each) {
  std::string xml =
      "    <testcase" + attribute("classname", each.group) + attribute("name", each.name) + attribute("time", seconds(each.wall_s));
  if (each.end == End::passed && each.message.empty()) return xml + "/>\n";
  xml += ">\n";
  const std::string message = attribute("message", each.message);
  switch (each.end) {
    case End::passed: xml += "      <system-out>" + escape_html(each.message) + "</system-out>\n"; break;
    case End::skipped: xml += "      <skipped" + message + "/>\n"; break;
    case End::failed:
    case End::error: {
      const std::string element = each.end == End::failed ? "failure" : "error";
      xml += "      <" + element + message + attribute("type", each.kind) + ">" + escape_html(each.kind + ": " + each.message) + "</" +
             element + ">\n";
    }
  }
  return xml + "    </testcase>\n";
}

std::string counts(const TestSuite& suite) {
  const auto count = [&](End end) {
    return std::to_string(std::count_if(suite.cases.begin(), suite.cases.end(), [end](const TestCase& each) { return each.end == end; }));
  };
  double wall_s = 0;
  for (const TestCase& each : suite.cases) wall_s += std::isfinite(each.wall_s) ? each.wall_s : 0;
  return attribute("name", suite.name) + attribute("tests", std::to_string(suite.cases.size())) +
         attribute("failures", count(End::failed)) + attribute("errors", count(End::error)) + attribute("skipped", count(End::skipped)) +
         attribute("time", seconds(wall_s));
}

TestCase case_of(const RunSummary& run) {
  TestCase each;
  each.name = "seed " + std::to_string(run.seed);
  each.wall_s = run.wall_s;
  if (run.success) {
    if (!run.as_expected.empty()) each.message = "it failed as expected: " + run.as_expected;
    return each;
  }
  each.kind = run.failure ? run.failure->phase : "?";
  each.message = run.failure ? run.failure->reason : "no reason was given";
  if (run.false_success) each.message = "FALSE SUCCESS: " + each.message;
  each.end = run.digest.empty() ? End::error : End::failed;  // a run that was flown has a digest
  return each;
}

}  // namespace

std::string junit_xml(const TestSuite& suite) {
  // The format has no zone for its time stamp, which is UTC.
  std::string begun = suite.begun;
  if (begun.ends_with('Z')) begun.pop_back();
  std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" + counts(suite) + ">\n  <testsuite" + counts(suite) +
                    (begun.empty() ? "" : attribute("timestamp", begun)) + ">\n";
  if (!suite.properties.empty()) {
    xml += "    <properties>\n";
    for (const auto& [name, value] : suite.properties)
      xml += "      <property" + attribute("name", name) + attribute("value", value) + "/>\n";
    xml += "    </properties>\n";
  }
  for (const TestCase& each : suite.cases) xml += case_xml(each);
  return xml + "  </testsuite>\n</testsuites>\n";
}

TestSuite suite_of(const Campaign& campaign) {
  TestSuite suite;
  suite.name = campaign.scenario;
  if (!campaign.sittings.empty()) suite.begun = campaign.sittings.back().begun;
  suite.properties = {{"command", campaign.command}, {"version", campaign.version}, {"revision", campaign.revision}};
  for (const Cell& cell : campaign.cells) {
    const std::string label = label_of(cell.choice);
    const std::string group = label.empty() ? campaign.scenario : campaign.scenario + ": " + label;
    for (const RunSummary& run : cell.runs) {
      suite.cases.push_back(case_of(run));
      suite.cases.back().group = group;
    }
    for (const std::uint64_t seed : cell.not_flown)
      suite.cases.push_back(
          {group, "seed " + std::to_string(seed), End::skipped, "", "not flown: the campaign was interrupted", record::unknown});
  }
  return suite;
}

}  // namespace lf::campaign
