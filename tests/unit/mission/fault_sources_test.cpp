// The steps' time-outs: no step of a mission outlasts its plan by more than its margin, whatever it waits for.
#include "firmware/mission/fault_sources.hpp"

#include <gtest/gtest.h>

namespace lf::mission {
namespace {

using safety::Fault;

// A robot that does nothing, in a step that was planned to take `planned_s`.
class Waiting {
 public:
  Waiting(Step step, double planned_s) : step_(step) {
    clock_.start(Time());
    clock_.expect(Duration::from_s(planned_s));
  }

  // How often the step has timed out by `t_s`, when it is looked at once.
  std::size_t timeouts_at(double t_s) {
    faults_.clear();
    FaultSources sources(config_.arm, config_.mission_limits);
    const StepTick tick{Time::from_s(t_s), step_, network_, orders_, telemetry_, bench_, faults_, clock_};
    sources.collect(tick, safety::Vigilance::bus);
    std::size_t count = 0;
    for (const safety::FaultReport& report : faults_.reports()) count += report.fault == Fault::step_timeout ? 1 : 0;
    return count;
  }

 private:
  ControllerConfig config_;
  canopen::Network network_{config_.network};
  ScanOrders orders_;
  Telemetry telemetry_;
  Workbench bench_{config_};
  safety::FaultArbiter faults_;
  StepClock clock_;
  Step step_;
};

// The margins are those of docs/mission.md.
TEST(StepTimeout, ComesAfterThePlanAndTheMargin) {
  Waiting deploy(Step::deploy, 7);
  EXPECT_EQ(deploy.timeouts_at(26.99), 0u) << "7 s and 20 s";
  EXPECT_EQ(deploy.timeouts_at(27.01), 1u);
  Waiting perceive(Step::perceive, 0);
  EXPECT_EQ(perceive.timeouts_at(4.99), 0u);
  EXPECT_EQ(perceive.timeouts_at(5.01), 1u);
}

TEST(StepTimeout, NeverComesInAStepThatWaitsForOrdersOrIsAnEnd) {
  for (const Step step : {Step::idle, Step::ready, Step::done, Step::failed, Step::held, Step::stopped, Step::off})
    EXPECT_EQ(Waiting(step, 0).timeouts_at(7200), 0u) << row(step).name;
}

TEST(StepTimeout, EveryOtherStepHasOne) {
  for (std::size_t i = 0; i < step_count; ++i) {
    const auto step = static_cast<Step>(i);
    if (is_end(step) || step == Step::idle || step == Step::ready) continue;
    EXPECT_EQ(Waiting(step, 0).timeouts_at(60), 1u) << row(step).name;
  }
}

}  // namespace
}  // namespace lf::mission
