// An earlier campaign held against a later one of the same scenario: what got better, what got worse, and whether that is more than chance.
//
// Runs of one seed are a pair: everything random was drawn alike. Success and false success are tested by McNemar's exact test over these pairs when both
// campaigns flew the same seeds, else by Fisher's exact test over all runs. A figure is compared over the pairs in which both runs have it: its median by
// Wilcoxon's signed-rank test, its p95 by a permutation test. All tests in which anything differs count together (Holm): that any verdict is by chance has a
// probability of at most 5 %. Tests in which nothing differs could say nothing and are not counted (Tarone, Biometrics 46, 1990).
//
// Among so many tests a fall of success can be lost. So whether failures, and whether false successes, rose over all cells together is tested apart from these:
// one-sided, each at its own level of 5 %.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign.hpp"

namespace lf::campaign {

struct Change {
  enum class Verdict { same, better, worse };
  std::string cell;              // its label; empty without a grid
  std::string figure, of, unit;  // "success", "share"; "peak_rms_px", "p95", "px"
  double before = record::unknown, after = record::unknown;
  std::string before_counts{}, after_counts{};  // "48 of 50", of shares
  std::string test{};                           // "" of what is not tested: it depends on the machine
  std::size_t n = 0;                            // pairs, or runs of both
  bool differs = false;                         // in any pair; of shares of other seeds: in themselves
  double p = 1, p_of_all = 1;                   // p_of_all: as it counts among all tests; p of a test that stands by itself
  Verdict verdict = Verdict::same;              // by p_of_all
};

// A seed that came to another end.
struct Turn {
  std::string cell;
  std::uint64_t seed = 0;
  bool success = false;  // now
  std::string before, after;
};

struct Comparison {
  std::string with;  // the earlier campaign, as it was named
  std::vector<Change> changes;
  std::vector<Turn> turns;
  std::vector<std::string> notes;  // what differs between the two that is no reason against comparing; what was left out
  std::size_t tests = 0, pairs = 0;
  bool identical = false;  // all pairs, bit by bit
  std::string doubt;       // why nothing could have been found; empty: something could

  bool worse() const;
  bool better() const;
};

// Throws InputError where the two cannot be compared, with the reason: no cell in common, or another scenario. Keys of the scenario that are in `across` may
// differ; those that only one of the two programs has, other programs and other files may, too, and are noted. `later` needs no runs yet.
std::vector<std::string> check_comparable(const Campaign& earlier, const Campaign& later, const std::vector<std::string>& across);

// Throws as check_comparable, and when one of them has no run.
Comparison compare(const Campaign& earlier, const Campaign& later, const std::vector<std::string>& across, const std::string& with);

// For a terminal: what was tested and came out, without those that are the same.
std::string text_of(const Comparison& comparison);
nlohmann::ordered_json json_of(const Comparison& comparison);

}  // namespace lf::campaign
