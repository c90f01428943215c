// The state machine's table against one written by hand from CiA 402-2, and against the page that users read.
#include "firmware/canopen/cia402.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace lf::canopen {
namespace {

using Row = std::map<DriveGoal, std::uint16_t>;

// Written from the standard's figure, not from the code: where a drive is, where it should go, the controlword.
const std::map<DriveState, Row>& by_hand() {
  using S = DriveState;
  using G = DriveGoal;
  static const std::map<S, Row> table{
      {S::not_ready, {{G::disabled, 0x00}, {G::enabled, 0x00}, {G::resumed, 0x00}, {G::quick_stop, 0x00}, {G::fault_reset, 0x00}}},
      {S::switch_on_disabled, {{G::disabled, 0x00}, {G::enabled, 0x06}, {G::resumed, 0x06}, {G::quick_stop, 0x02}, {G::fault_reset, 0x00}}},
      {S::ready_to_switch_on, {{G::disabled, 0x00}, {G::enabled, 0x07}, {G::resumed, 0x07}, {G::quick_stop, 0x02}, {G::fault_reset, 0x00}}},
      {S::switched_on, {{G::disabled, 0x06}, {G::enabled, 0x0F}, {G::resumed, 0x0F}, {G::quick_stop, 0x02}, {G::fault_reset, 0x00}}},
      {S::operation_enabled, {{G::disabled, 0x07}, {G::enabled, 0x0F}, {G::resumed, 0x0F}, {G::quick_stop, 0x02}, {G::fault_reset, 0x00}}},
      {S::quick_stop_active, {{G::disabled, 0x00}, {G::enabled, 0x00}, {G::resumed, 0x0F}, {G::quick_stop, 0x02}, {G::fault_reset, 0x00}}},
      {S::fault_reaction, {{G::disabled, 0x00}, {G::enabled, 0x00}, {G::resumed, 0x00}, {G::quick_stop, 0x00}, {G::fault_reset, 0x00}}},
      {S::fault, {{G::disabled, 0x00}, {G::enabled, 0x00}, {G::resumed, 0x00}, {G::quick_stop, 0x00}, {G::fault_reset, 0x80}}},
      {S::unknown, {{G::disabled, 0x00}, {G::enabled, 0x00}, {G::resumed, 0x00}, {G::quick_stop, 0x02}, {G::fault_reset, 0x00}}},
  };
  return table;
}

TEST(Cia402, EveryStateAndGoalLeadsToTheControlwordOfTheStandard) {
  std::size_t cells = 0;
  for (const auto& [state, row] : by_hand()) {
    for (const auto& [goal, word] : row) {
      EXPECT_EQ(static_cast<std::uint16_t>(command_for(state, goal)), word) << name(state) << ", goal " << static_cast<int>(goal);
      ++cells;
    }
  }
  EXPECT_EQ(cells, drive_state_count * drive_goal_count);
}

// Bits 0-3, 5, 6 as the standard's table draws them, x for "does not matter".
DriveState by_pattern(std::uint16_t word) {
  const std::vector<std::pair<std::string, DriveState>> patterns{
      {"x0xx0000", DriveState::not_ready},          {"x1xx0000", DriveState::switch_on_disabled},
      {"x01x0001", DriveState::ready_to_switch_on}, {"x01x0011", DriveState::switched_on},
      {"x01x0111", DriveState::operation_enabled},  {"x00x0111", DriveState::quick_stop_active},
      {"x0xx1111", DriveState::fault_reaction},     {"x0xx1000", DriveState::fault},
  };
  for (const auto& [pattern, state] : patterns) {
    bool fits = true;
    for (int bit = 0; bit < 8; ++bit) {
      const char wanted = pattern[static_cast<std::size_t>(7 - bit)];
      const bool set = ((word >> bit) & 1) != 0;
      fits = fits && (wanted == 'x' || (wanted == '1') == set);
    }
    if (fits) return state;
  }
  return DriveState::unknown;
}

TEST(Cia402, EveryStatuswordDecodesAsTheStandardDrawsIt) {
  for (std::uint32_t word = 0; word <= 0xFFFF; ++word) {
    ASSERT_EQ(decode_statusword(static_cast<std::uint16_t>(word)), by_pattern(static_cast<std::uint16_t>(word))) << std::hex << word;
  }
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, '|');) {
    const auto first = cell.find_first_not_of(' ');
    const auto last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

TEST(Cia402, TheTableInTheDocumentationIsTheCodesTable) {
  std::ifstream in(LANTERNFISH_SOURCE_DIR "/docs/canopen.md");
  ASSERT_TRUE(in) << "docs/canopen.md";
  std::size_t rows = 0;
  for (std::string line; std::getline(in, line);) {
    const auto cells = cells_of(line);
    if (cells.size() < 2 + drive_goal_count) continue;
    for (std::size_t s = 0; s < drive_state_count; ++s) {
      const auto state = static_cast<DriveState>(s);
      if (cells[1] != name(state)) continue;
      ++rows;
      for (std::size_t g = 0; g < drive_goal_count; ++g) {
        const auto word = static_cast<std::uint16_t>(command_for(state, static_cast<DriveGoal>(g)));
        EXPECT_EQ(std::stoul(cells[2 + g], nullptr, 16), word) << line;
      }
    }
  }
  EXPECT_EQ(rows, drive_state_count);
}

}  // namespace
}  // namespace lf::canopen
