#include "host_sim/campaign/comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "host_sim/campaign/figures.hpp"
#include "host_sim/campaign/statistics/count_tests.hpp"
#include "host_sim/campaign/statistics/holm.hpp"
#include "host_sim/campaign/statistics/pair_tests.hpp"
#include "host_sim/campaign/statistics/percentile.hpp"
#include "shared/input_error.hpp"

namespace lf::campaign {
namespace {

struct Pair {
  const RunSummary* before = nullptr;
  const RunSummary* after = nullptr;
};

std::vector<Pair> pairs_of(const Cell& earlier, const Cell& later) {
  std::map<std::uint64_t, const RunSummary*> by_seed;
  for (const RunSummary& run : earlier.runs) by_seed[run.seed] = &run;
  std::vector<Pair> pairs;
  for (const RunSummary& run : later.runs) {
    if (const auto found = by_seed.find(run.seed); found != by_seed.end()) pairs.push_back({found->second, &run});
  }
  return pairs;
}

// A test that was made: which of the changes it is of, whether anything differed, which way, and the smallest p that it could have come to.
struct Test {
  std::size_t change = 0;
  bool differs = false, is_worse = false;
  double least_p = 1;
};

std::string counts(std::size_t hits, std::size_t of) { return std::to_string(hits) + " of " + std::to_string(of); }

// Runs of both campaigns that came to an end which should not become more frequent, over all cells.
struct Rise {
  const char* name;
  bool (*hit)(const RunSummary&);
  std::size_t before = 0, of_before = 0, after = 0, of_after = 0;
  std::size_t vanished = 0, came = 0;  // pairs in which it was so before only, and now only
  bool paired = true;

  void add(const Cell& earlier, const Cell& later) {
    const auto hits = [this](const Cell& cell) { return static_cast<std::size_t>(std::count_if(cell.runs.begin(), cell.runs.end(), hit)); };
    const std::vector<Pair> pairs = pairs_of(earlier, later);
    before += hits(earlier), of_before += earlier.runs.size();
    after += hits(later), of_after += later.runs.size();
    paired = paired && pairs.size() == earlier.runs.size() && pairs.size() == later.runs.size();
    for (const Pair& pair : pairs) {
      vanished += hit(*pair.before) && !hit(*pair.after) ? 1 : 0;
      came += !hit(*pair.before) && hit(*pair.after) ? 1 : 0;
    }
  }

  Change change(const std::string& cell) const {
    Change change{cell, name, "share", ""};
    change.before = static_cast<double>(before) / static_cast<double>(of_before);
    change.after = static_cast<double>(after) / static_cast<double>(of_after);
    change.before_counts = counts(before, of_before);
    change.after_counts = counts(after, of_after);
    change.test = paired ? "McNemar, one-sided, by itself" : "Fisher, one-sided, by itself";
    change.n = paired ? of_after : of_before + of_after;
    change.differs = paired ? came + vanished > 0 : before * of_after != after * of_before;
    change.p = change.p_of_all = paired ? mcnemar_rise(vanished, came) : fisher_rise(before, of_before, after, of_after);
    if (change.p < beyond_chance) change.verdict = Change::Verdict::worse;
    return change;
  }
};

class Comparer {
 public:
  Comparer(const Cell& earlier, const Cell& later, Comparison& comparison, std::vector<Test>& tests)
      : earlier_(earlier),
        later_(later),
        cell_(label_of(later.choice)),
        pairs_(pairs_of(earlier, later)),
        comparison_(comparison),
        tests_(tests) {}

  void compare() {
    comparison_.pairs += pairs_.size();
    for (const Pair& pair : pairs_) {
      comparison_.identical = comparison_.identical && !pair.after->digest.empty() && pair.before->digest == pair.after->digest;
      if (pair.before->success != pair.after->success)
        comparison_.turns.push_back({cell_, pair.after->seed, pair.after->success, verdict_of(*pair.before), verdict_of(*pair.after)});
    }
    share("success", &RunSummary::success, false);
    share("false success", &RunSummary::false_success, true);
    for (std::size_t i = 0; i < figures().size(); ++i) figure(i);
  }

 private:
  void share(const char* name, bool RunSummary::*hit, bool more_is_worse) {
    const auto hits = [&](const Cell& cell) {
      return static_cast<std::size_t>(std::count_if(cell.runs.begin(), cell.runs.end(), [&](const RunSummary& run) { return run.*hit; }));
    };
    const std::size_t was = hits(earlier_), is = hits(later_), of_was = earlier_.runs.size(), of_is = later_.runs.size();
    if (of_was == 0 || of_is == 0) return;
    Change change{cell_, name, "share", ""};
    change.before = static_cast<double>(was) / static_cast<double>(of_was);
    change.after = static_cast<double>(is) / static_cast<double>(of_is);
    change.before_counts = counts(was, of_was);
    change.after_counts = counts(is, of_is);
    Test test;
    test.is_worse = (change.after > change.before) == more_is_worse;
    if (pairs_.size() == of_was && pairs_.size() == of_is) {
      std::size_t gained = 0, lost = 0;
      for (const Pair& pair : pairs_) {
        gained += !(pair.before->*hit) && pair.after->*hit ? 1 : 0;
        lost += pair.before->*hit && !(pair.after->*hit) ? 1 : 0;
      }
      change.test = "McNemar";
      change.n = pairs_.size();
      change.p = mcnemar(gained, lost);
      test.differs = gained + lost > 0;
      test.least_p = mcnemar(0, pairs_.size());
    } else {
      change.test = "Fisher";
      change.n = of_was + of_is;
      change.p = fisher(was, of_was, is, of_is);
      test.differs = was * of_is != is * of_was;
      test.least_p = fisher(of_was, of_was, 0, of_is);
    }
    add(std::move(change), test);
  }

  void figure(std::size_t index) {
    const Figure& figure = figures()[index];
    const double sign = figure.good == Figure::Good::more ? -1 : 1;  // the larger, the worse
    std::vector<double> before, after;
    for (const Pair& pair : pairs_) {
      const double was = pair.before->figures[index], is = pair.after->figures[index];
      if (!std::isfinite(was) || !std::isfinite(is)) continue;
      before.push_back(sign * was);
      after.push_back(sign * is);
    }
    if (before.empty()) return;
    Test test;
    for (std::size_t i = 0; i < before.size(); ++i) test.differs = test.differs || differ(before[i], after[i]);
    test.least_p = std::ldexp(2.0, -static_cast<int>(before.size()));
    for (const auto& [of, at] : {std::pair{"median", 0.5}, std::pair{"p95", 0.95}}) {
      Change change{cell_, figure.name, of, figure.unit};
      std::vector<double> a = before, b = after;
      const double was = nearest_rank(a, at), is = nearest_rank(b, at);
      change.before = sign * was;
      change.after = sign * is;
      change.n = before.size();
      if (figure.of_the_machine) {
        comparison_.changes.push_back(std::move(change));
        continue;
      }
      const bool median = at == 0.5;
      change.test = median ? "Wilcoxon" : "permutation";
      change.p = median ? wilcoxon(before, after) : swap_test(before, after, at);
      test.is_worse = median ? moved_up(before, after) : is > was;
      add(std::move(change), test);
    }
  }

  // Which way the pairs moved, by the signed ranks' own measure: the two medians may be equal when the pairs have moved.
  static bool moved_up(const std::vector<double>& before, const std::vector<double>& after) {
    std::vector<double> differences;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (differ(before[i], after[i])) differences.push_back(after[i] - before[i]);
    }
    std::sort(differences.begin(), differences.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    double balance = 0;
    for (std::size_t i = 0; i < differences.size(); ++i)
      balance += differences[i] > 0 ? static_cast<double>(i + 1) : -static_cast<double>(i + 1);
    return balance > 0;
  }

  void add(Change change, Test test) {
    test.change = comparison_.changes.size();
    change.differs = test.differs;
    comparison_.changes.push_back(std::move(change));
    tests_.push_back(test);
  }

  const Cell& earlier_;
  const Cell& later_;
  std::string cell_;
  std::vector<Pair> pairs_;
  Comparison& comparison_;
  std::vector<Test>& tests_;
};

void judge(const std::vector<Test>& tests, Comparison& comparison) {
  std::vector<double> p;
  std::vector<const Test*> counted;
  for (const Test& test : tests) {
    if (!test.differs) continue;
    counted.push_back(&test);
    p.push_back(comparison.changes[test.change].p);
  }
  comparison.tests = p.size();
  const std::vector<double> adjusted = holm(p);
  bool could = false;
  for (std::size_t i = 0; i < counted.size(); ++i) {
    Change& change = comparison.changes[counted[i]->change];
    change.p_of_all = adjusted[i];
    could = could || counted[i]->least_p * static_cast<double>(p.size()) < beyond_chance;
    if (change.p_of_all < beyond_chance) change.verdict = counted[i]->is_worse ? Change::Verdict::worse : Change::Verdict::better;
  }
  if (p.empty() || could || comparison.worse()) return;
  std::size_t enough = 1;
  while (std::ldexp(2.0, -static_cast<int>(enough)) * static_cast<double>(p.size()) >= beyond_chance) ++enough;
  comparison.doubt = "too few runs to tell a change from chance: with " + std::to_string(p.size()) + " tests that differ it takes " +
                     std::to_string(enough) + " common seeds that finish; there are " + std::to_string(comparison.pairs);
}

}  // namespace

bool Comparison::worse() const {
  return std::any_of(changes.begin(), changes.end(), [](const Change& change) { return change.verdict == Change::Verdict::worse; });
}

bool Comparison::better() const {
  return std::any_of(changes.begin(), changes.end(), [](const Change& change) { return change.verdict == Change::Verdict::better; });
}

Comparison compare(const Campaign& earlier, const Campaign& later, const std::vector<std::string>& across, const std::string& with) {
  Comparison comparison;
  comparison.with = with;
  comparison.notes = check_comparable(earlier, later, across);
  comparison.identical = true;
  std::vector<Test> tests;
  std::array<Rise, 2> rises{Rise{"failures", [](const RunSummary& run) { return !run.success; }},
                            Rise{"false successes", [](const RunSummary& run) { return run.false_success; }}};
  std::size_t before = 0, after = 0;
  for (const Cell& cell : later.cells) {
    const auto same = [&](const Cell& other) { return label_of(other.choice) == label_of(cell.choice); };
    const auto found = std::find_if(earlier.cells.begin(), earlier.cells.end(), same);
    if (found == earlier.cells.end()) continue;
    before += found->runs.size();
    after += cell.runs.size();
    Comparer(*found, cell, comparison, tests).compare();
    for (Rise& rise : rises) rise.add(*found, cell);
  }
  if (before == 0) throw InputError("the campaigns are not comparable: no run of the earlier one was flown");
  if (after == 0) throw InputError("the campaigns are not comparable: no run of the later one was flown");
  comparison.identical = comparison.identical && comparison.pairs > 0;
  if (comparison.pairs == 0) comparison.notes.emplace_back("they have no seed in common: only the shares of success are compared");
  for (const Rise& rise : rises) comparison.changes.push_back(rise.change(later.cells.size() > 1 ? "all cells" : ""));
  judge(tests, comparison);
  return comparison;
}

}  // namespace lf::campaign
