// What the runs of a campaign came to together.
#pragma once

#include <string>
#include <vector>

#include "host_sim/app/command.hpp"
#include "host_sim/record/result.hpp"

namespace lf::app {

struct Spread3 {
  double median = record::unknown, p95 = record::unknown, worst = record::unknown;
};

struct ErrorColumn {
  std::string name, unit;
  Spread3 values;
};

struct CampaignTable {
  std::size_t runs = 0, successes = 0, false_successes = 0;
  std::vector<ErrorColumn> errors;  // over all runs that have the figure; of recall the worst is the smallest
  std::vector<record::RunResult> failures;
};

CampaignTable tabulate(const std::vector<record::RunResult>& results);
void tell(const CampaignTable& table);
Json json_of(const CampaignTable& table);

}  // namespace lf::app
