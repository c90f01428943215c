// docs/mission.md shows the mission and its faults; here they are drawn again from the tables and compared.
// To bring the page up to date: LANTERNFISH_UPDATE_DOCS=1 build/release/tests/test_mission --gtest_filter='Drawing.*'
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "firmware/mission/orders.hpp"
#include "firmware/mission/steps.hpp"
#include "firmware/safety/faults.hpp"

namespace lf::mission {
namespace {

std::string node(Step step) {
  std::string name = row(step).name;
  for (char& c : name) {
    if (c == ' ' || c == ',') c = '_';
  }
  return name;
}

std::string steps_drawing() {
  std::ostringstream out;
  out << "```mermaid\nstateDiagram-v2\n  [*] --> idle\n";
  for (std::size_t i = 0; i < step_count; ++i) {
    const StepRow& from = row(static_cast<Step>(i));
    if (is_end(from.step)) {
      out << "  " << node(from.step) << " --> [*]\n";
      continue;
    }
    out << "  " << node(from.step) << " --> " << node(from.on_done) << "\n";
    if (from.on_branch != from.on_done) out << "  " << node(from.step) << " --> " << node(from.on_branch) << ": or\n";
    if (from.on_retry != Step::count) out << "  " << node(from.step) << " --> " << node(from.on_retry) << ": retry\n";
    if (from.on_end != Step::count) out << "  " << node(from.step) << " --> " << node(from.on_end) << ": nothing left\n";
  }
  out << "```\n";
  return out.str();
}

std::string steps_table() {
  std::ostringstream out;
  out << "| step | stage | phase | times out after its plan and (s) | tried again from |\n|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < static_cast<std::size_t>(Step::done); ++i) {
    const StepRow& step = row(static_cast<Step>(i));
    out << "| " << step.name << " | " << step.stage << " | " << safety::name(step.phase) << " | ";
    if (step.margin_s > 0) out << step.margin_s;
    out << " | " << (step.on_retry == Step::count ? "" : row(step.on_retry).name) << " |\n";
  }
  return out.str();
}

std::string faults_table() {
  std::ostringstream out;
  out << "| fault |";
  for (std::size_t p = 0; p < safety::phase_count; ++p) out << " " << safety::name(static_cast<safety::Phase>(p)) << " |";
  out << "\n|---|";
  for (std::size_t p = 0; p < safety::phase_count; ++p) out << "---|";
  out << "\n";
  for (std::size_t f = 0; f < safety::fault_count; ++f) {
    const auto fault = static_cast<safety::Fault>(f);
    out << "| " << safety::name(fault) << " |";
    for (std::size_t p = 0; p < safety::phase_count; ++p) {
      out << " " << safety::name(safety::reaction(fault, static_cast<safety::Phase>(p))) << " |";
    }
    out << "\n";
  }
  return out.str();
}

std::string orders_table() {
  std::ostringstream out;
  out << "| order |";
  for (std::size_t s = 0; s < standing_count; ++s) out << " " << name(static_cast<Standing>(s)) << " |";
  out << "\n|---|";
  for (std::size_t s = 0; s < standing_count; ++s) out << "---|";
  out << "\n";
  for (std::size_t c = 0; c < command_count; ++c) {
    const auto command = static_cast<Command>(c);
    out << "| " << lf::name(command) << " |";
    for (std::size_t s = 0; s < standing_count; ++s) out << (may(command, static_cast<Standing>(s)) ? " yes |" : " |");
    out << "\n";
  }
  return out.str();
}

const std::string page = std::string(LANTERNFISH_SOURCE_DIR) + "/docs/mission.md";

std::string read_page() {
  std::ifstream file(page);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void expect_on_page(const std::string& mark, const std::string& drawn) {
  const std::string begin = "<!-- " + mark + ": drawn from the code -->\n";
  const std::string end = "<!-- end -->";
  std::string text = read_page();
  const std::size_t first = text.find(begin);
  ASSERT_NE(first, std::string::npos) << page << " has no mark for the " << mark;
  const std::size_t start = first + begin.size();
  const std::size_t stop = text.find(end, start);
  ASSERT_NE(stop, std::string::npos);
  if (std::getenv("LANTERNFISH_UPDATE_DOCS") != nullptr) {
    text.replace(start, stop - start, drawn);
    std::ofstream(page) << text;
    return;
  }
  EXPECT_EQ(text.substr(start, stop - start), drawn) << page << " is not up to date";
}

TEST(Drawing, OfTheStepsIsTheTable) { expect_on_page("steps", steps_drawing()); }
TEST(Drawing, OfTheStepsTimesIsTheTable) { expect_on_page("step table", steps_table()); }
TEST(Drawing, OfTheOrdersIsTheTable) { expect_on_page("orders", orders_table()); }
TEST(Drawing, OfTheFaultsIsTheTable) { expect_on_page("faults", faults_table()); }

}  // namespace
}  // namespace lf::mission
