// A fault campaign as JUnit XML.
#pragma once

#include <string>
#include <vector>

#include "host_sim/app/fault_table.hpp"
#include "host_sim/campaign/junit.hpp"

namespace lf::app {

// A case a row, grouped by kind. It fails as it fails the campaign: unsafe, a false success, or an end that does not say what happened. Rows that must go on
// may fail, up to a share: that is a case of its own at the end. `not_flown`: rows that an interrupt came before.
campaign::TestSuite fault_suite(const std::string& scenario, const std::vector<RowResult>& rows, const FaultTable& table,
                                const std::vector<std::string>& not_flown);

}  // namespace lf::app
