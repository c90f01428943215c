#include "firmware/scan/stripe_chain.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <vector>

namespace lf::scan {
namespace {

std::vector<int> chains_of(const std::vector<Peak>& peaks, float step_px = 2.5f) {
  std::vector<std::uint8_t> columns(peaks.size());
  measure_chains(peaks, step_px, columns);
  return {columns.begin(), columns.end()};
}

TEST(StripeChain, GoesOnFromColumnToColumnOverAMissingOne) {
  std::vector<Peak> peaks;
  for (int u = 10; u < 40; ++u) {
    if (u == 20 || u == 30 || u == 31) continue;
    peaks.push_back({static_cast<float>(u), 100 + 1.5f * static_cast<float>(u)});
  }
  const std::vector<int> columns = chains_of(peaks);
  for (std::size_t i = 0; i < peaks.size(); ++i)
    EXPECT_EQ(columns[i], peaks[i].u_px < 30 ? 19 : 8) << peaks[i].u_px << ": two in a row end it";
}

TEST(StripeChain, APieceBeforeThePanelIsAChainOfItsOwn) {
  std::vector<Peak> peaks;
  for (int u = 0; u < 100; ++u) {
    peaks.push_back({static_cast<float>(u), 200});
    if (u >= 40 && u < 47) peaks.push_back({static_cast<float>(u), 150});
    if (u == 70) peaks.push_back({70, 203.9f});  // 3.9 px off: no neighbour of its own column's, two columns off it is in reach
  }
  const std::vector<int> columns = chains_of(peaks);
  for (std::size_t i = 0; i < peaks.size(); ++i)
    EXPECT_EQ(columns[i], peaks[i].v_px == 150 ? 7 : peaks[i].v_px == 200 ? 100 : 69 + 1 + 28) << peaks[i].u_px << " " << peaks[i].v_px;
}

TEST(StripeChain, IsCountedToAtMost255) {
  std::vector<Peak> peaks;
  for (int u = 0; u < 640; ++u) peaks.push_back({static_cast<float>(u), 200});
  for (const int columns : chains_of(peaks)) EXPECT_EQ(columns, 255);
  EXPECT_TRUE(chains_of({}).empty());
}

// The same bar in the picture of another camera.
TEST(StripeChain, PartsAreAsWideInAngleForEveryCamera) {
  const ChainConfig config;
  EXPECT_EQ(config.part_columns(361.7), 5);
  EXPECT_EQ(config.panel_columns(361.7), 24);
  EXPECT_EQ(config.part_columns(180.9), 4) << "binned";
  EXPECT_EQ(config.part_columns(1085), 11);
  EXPECT_EQ(config.panel_columns(1e9), 255);
  EXPECT_EQ(config.part_columns(0), 4);
}

// Against all chains, searched one by one.
TEST(StripeChain, IsTheLongestOfAll) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(100, 112);
    std::vector<Peak> peaks;
    for (int u = 0; u < 12; ++u) {
      for (int k = static_cast<int>(random() % 4); k > 0; --k) peaks.push_back({static_cast<float>(u), place(random)});
    }
    const auto linked = [&](std::size_t a, std::size_t b) {
      const float apart = peaks[b].u_px - peaks[a].u_px;
      return apart > 0.5f && apart < 2.5f && std::abs(peaks[b].v_px - peaks[a].v_px) <= 2.5f * apart;
    };
    const std::function<int(std::size_t, bool)> longest = [&](std::size_t i, bool right) {
      int most = 0;
      for (std::size_t j = 0; j < peaks.size(); ++j) {
        if (right ? linked(i, j) : linked(j, i)) most = std::max(most, longest(j, right));
      }
      return most + 1;
    };
    const std::vector<int> columns = chains_of(peaks);
    for (std::size_t i = 0; i < peaks.size(); ++i) EXPECT_EQ(columns[i], longest(i, true) + longest(i, false) - 1) << i;
  }
}

}  // namespace
}  // namespace lf::scan
