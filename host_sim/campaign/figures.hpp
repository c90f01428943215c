// The figures of a run that a campaign tabulates, draws and compares. A new one is a row of figures.cpp.
#pragma once

#include <span>
#include <vector>

#include "host_sim/record/result.hpp"

namespace lf::campaign {

struct Figure {
  const char* name;   // in JSON and CSV
  const char* title;  // for a person
  const char* unit;
  double (*of)(const record::RunResult&);  // NaN where the run has none
  enum class Good { less, more } good = Good::less;
  bool of_the_machine = false;  // it depends on the computer that flew it, so a comparison draws no conclusion from it
};

std::span<const Figure> figures();

// Of one run, in the order of figures().
std::vector<double> figures_of(const record::RunResult& result);

// Below 0 when `a` is better, above when `b` is.
double compare_worse(const Figure& figure, double a, double b);

}  // namespace lf::campaign
