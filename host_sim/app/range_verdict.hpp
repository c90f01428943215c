// What one row of a range campaign came to.
#pragma once

#include <functional>

#include "host_sim/app/range_draws.hpp"
#include "host_sim/app/range_suite.hpp"
#include "host_sim/record/result.hpp"

namespace lf::app {

// `prepare` loads and checks the scenario, `fly` flies the mission. Only what `prepare` refuses is refused, and it has to name a drawn key: else the row is
// unnamed. An InputError out of `fly` is one that no check had found, and is unsafe.
RangeResult verdict_of(const RangeRow& row, const std::function<void()>& prepare, const std::function<record::RunResult()>& fly);

}  // namespace lf::app
