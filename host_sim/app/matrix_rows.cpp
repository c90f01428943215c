#include "host_sim/app/matrix_rows.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <span>

#include "hal/config/key_text.hpp"
#include "hal/config/nearest.hpp"
#include "host_sim/scenario/draw.hpp"
#include "shared/random.hpp"

namespace lf::app {
namespace {

using mission::Step;

constexpr double pairs_within_s = 0.5;

// A pair is taken in one step of each phase; of those that are long, in several.
constexpr std::array<Step, 9> pair_steps{Step::boot, Step::enable, Step::deploy, Step::scan,   Step::advance,
                                         Step::turn, Step::press,  Step::stow,   Step::stopped};

bool chosen(const std::vector<std::string>& names, const std::string& name) {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<MatrixRow> single_rows(const std::vector<FaultMoment>& moments, const MatrixChoice& choice, const judge::BusNodes& bus) {
  std::vector<MatrixRow> rows;
  for (const FaultMoment& moment : moments) {
    if (!chosen(choice.steps, moment.name)) continue;
    for (const judge::Cause& cause : judge::all_causes(bus)) {
      if (chosen(choice.kinds, cause.rule->kind) && happens_in(cause, moment.name)) rows.push_back({moment, {cause}, 0});
    }
  }
  return rows;
}

std::uint64_t sample_seed(const MatrixChoice& choice) {
  return choice.into == usual_share_of_step ? 1 : scenario::bits(1, "into " + config::number_text(choice.into));
}

// Every pair of rules in a step of every phase; which nodes, which is first, and how far apart, a hash of the pair says.
std::vector<MatrixRow> pair_rows(const std::vector<FaultMoment>& moments, const MatrixChoice& choice, const judge::BusNodes& bus) {
  std::map<const judge::FaultRule*, std::vector<judge::Cause>> by_rule;
  for (const judge::Cause& cause : judge::all_causes(bus)) by_rule[cause.rule].push_back(cause);
  const std::span<const judge::FaultRule> rules = judge::fault_rules();
  std::vector<MatrixRow> rows;
  for (const FaultMoment& moment : moments) {
    if (!chosen(choice.steps, moment.name)) continue;
    if (std::find(pair_steps.begin(), pair_steps.end(), moment.step) == pair_steps.end()) continue;
    for (std::size_t a = 0; a < rules.size(); ++a) {
      for (std::size_t b = a; b < rules.size(); ++b) {
        if (!chosen(choice.kinds, rules[a].kind) && !chosen(choice.kinds, rules[b].kind)) continue;
        if (rules[a].kind == "limits_refused" || rules[b].kind == "limits_refused") continue;
        const std::uint64_t draw = splitmix64(splitmix64(a * 1000 + b) + static_cast<std::uint64_t>(moment.step));
        const std::vector<judge::Cause>&first = by_rule[&rules[a]], &second = by_rule[&rules[b]];
        MatrixRow row{moment, {first[draw % first.size()], second[(draw >> 16) % second.size()]}, 0};
        if ((draw >> 32) % 2 == 1) std::swap(row.causes[0], row.causes[1]);
        row.apart_s = pairs_within_s * static_cast<double>((draw >> 33) % 1000) / 1000;
        rows.push_back(row);
      }
    }
  }
  return rows;
}

void check_choice(const std::vector<FaultMoment>& moments, const MatrixChoice& choice) {
  std::vector<std::string> kinds, steps;
  for (const judge::FaultRule& rule : judge::fault_rules()) kinds.push_back(rule.kind);
  for (const FaultMoment& moment : moments) steps.push_back(moment.name);
  config::check_names(choice.kinds, kinds, "--kinds");
  config::check_names(choice.steps, steps, "--steps");
}

}  // namespace

bool happens_in(const judge::Cause& cause, const std::string& step) { return cause.rule->kind != "limits_refused" || step == "power-on"; }

std::string MatrixRow::name() const {
  std::string text = moment.name + ": " + causes.front().name();
  if (causes.size() < 2) return text;
  char later[32];
  std::snprintf(later, sizeof later, " %.4f s later", apart_s);
  return text + ", then " + causes[1].name() + later;
}

std::vector<MatrixRow> matrix_rows(const std::vector<FaultMoment>& moments, const MatrixChoice& choice, const judge::BusNodes& bus) {
  check_choice(moments, choice);
  const std::vector<MatrixRow> all = choice.pairs ? pair_rows(moments, choice, bus) : single_rows(moments, choice, bus);
  std::vector<std::string> names;
  names.reserve(all.size());
  for (const MatrixRow& row : all) names.push_back(row.name());
  config::check_names(choice.rows, names, "--rows");
  std::vector<MatrixRow> mine;
  const std::uint64_t seed = sample_seed(choice);
  // A sample is drawn by the rows' names: a stride would meet the same kinds at every moment.
  for (std::size_t i = choice.shard - 1; i < all.size(); i += choice.shards) {
    const bool drawn = choice.one_in <= 1 || scenario::bits(seed, all[i].name()) % choice.one_in == 0;
    if (drawn && chosen(choice.rows, all[i].name())) mine.push_back(all[i]);
  }
  return mine;
}

}  // namespace lf::app
