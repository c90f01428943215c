// What the rows of a fault matrix came to together: by kind of fault, and those that were not as they must be.
#pragma once

#include <string>
#include <vector>

#include "host_sim/app/command.hpp"
#include "host_sim/app/fault_matrix.hpp"

namespace lf::app {

struct FaultTable {
  struct Line {
    std::string kind;  // of a pair "pairs"
    std::size_t rows = 0, unsafe = 0, unclear = 0, false_success = 0, unfelt = 0, stood_anyway = 0, gave_way = 0, must_go_on = 0,
                went_on = 0;
    std::optional<double> stop_ms, standing_s, power_off_s, stop_to_off_s;  // the worst
    double force_n = 0;
  };
  std::vector<Line> kinds;
  std::vector<RowResult> bad;  // unsafe first, then unclear
  std::size_t rows = 0, unsafe = 0, unclear = 0, false_success = 0, unfelt = 0, stood_anyway = 0, gave_way = 0, must_go_on = 0, went_on = 0;
  std::size_t pushed = 0, seized = 0,
              gripped = 0;  // rows that may be `unfelt`, those that may have `stood_anyway`, and those that may have `gave_way`

  // No row was unsafe or unclear, of those that must go on at least 95 % did, and few were excused.
  bool good() const;
  // Of each sort at most one in ten that may be, and two more. The whole matrix had 1 of 36 and 8 of 180, all pairs 24 of 441; a sample of some 40 had 5.
  bool few_excused() const;
};

inline constexpr double go_on_share = 0.95, excused_share = 0.1;

FaultTable tabulate_faults(const std::vector<RowResult>& rows);
void tell(const FaultTable& table);
Json json_of(const FaultTable& table);
std::string markdown_of(const FaultTable& table, const std::string& command);
std::string csv_of(const std::vector<RowResult>& rows);

}  // namespace lf::app
