// A run made up from formulas, with everything a report shows.
#pragma once

#include "host_sim/record/report.hpp"

namespace lf::record::test {

ReportData demo_run();

}  // namespace lf::record::test
