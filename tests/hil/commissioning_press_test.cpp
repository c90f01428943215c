// How hard a commissioning presses: by the limit in the drive, and where a drive knows none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/hil/commissioning_bench.hpp"

namespace lf::test {
namespace {

using hal::Commissioning;
using Bench = CommissioningBench;

// The elbow alone, with a drive of some make. Its zero is near enough for one that counts in fine units.
class ElbowOfAMake {
 public:
  explicit ElbowOfAMake(const std::string& profile)
      : bench_(Zeros{0, 0, 7, 0, 0}, parked, {}, [](hal::SimConfig&) {}, {"drives.elbow.profile=" + profile}), commissioning_(config()) {
    const canopen::Ratio torque = bench_.nominal().controller.network.drives[2].profile.scale.torque;
    bench_.set_ear([this, torque](const CanFrame& frame) {
      if (frame.id != 0x183) return;
      const auto raw = static_cast<std::int16_t>(frame.data[6] | frame.data[7] << 8);
      const double permille = std::abs(1.0 * raw * torque.den / torque.num);
      hardest_permille_ = std::max(hardest_permille_, permille);
      too_hard_s_ += permille > 1.3 * allowed_permille ? 0.004 : 0;
    });
    bench_.run(commissioning_);
  }
  static constexpr double allowed_permille = 700;  // two thirds of the rated torque, as docs/operating.md promises for a screw
  const Bench& bench() const { return bench_; }
  const Commissioning& commissioning() const { return commissioning_; }
  double hardest_permille() const { return hardest_permille_; }
  double too_hard_s() const { return too_hard_s_; }

 private:
  Commissioning::Config config() const {
    Commissioning::Config config = bench_.config();
    config.joints = {false, false, true, false, false};
    return config;
  }
  Bench bench_;
  Commissioning commissioning_;
  double hardest_permille_ = 0, too_hard_s_ = 0;
};

std::string make_name(const testing::TestParamInfo<const char*>& make) { return make.param; }

class CommissioningOfADriveWithALimit : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, CommissioningOfADriveWithALimit, testing::Values("elmo_gold", "c5e", "eyou"), make_name);

TEST_P(CommissioningOfADriveWithALimit, FindsItsZero) {
  const ElbowOfAMake elbow(GetParam());
  ASSERT_EQ(elbow.commissioning().state(), Commissioning::State::done) << elbow.commissioning().failure();
  EXPECT_LE(std::abs(elbow.bench().error_rad(2, elbow.commissioning().zero_counts()[2])), elbow.bench().tolerance_rad(2));
  EXPECT_LT(elbow.hardest_permille(), 1.1 * ElbowOfAMake::allowed_permille);
}

// Without 6072 they press with what their maker's tool allows: here the whole rated torque. They boot, move, and are stopped.
class CommissioningOfADriveWithoutALimit : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, CommissioningOfADriveWithoutALimit, testing::Values("epos4", "ipos", "ingenia", "lmdrive", "copley"),
                         make_name);

TEST_P(CommissioningOfADriveWithoutALimit, IsStoppedWhenItPressesTooHard) {
  const ElbowOfAMake elbow(GetParam());
  EXPECT_EQ(elbow.commissioning().state(), Commissioning::State::failed);
  EXPECT_NE(elbow.commissioning().failure().find("limit it to 70 % with its maker's tool"), std::string_view::npos)
      << elbow.commissioning().failure();
  EXPECT_GT(elbow.hardest_permille(), 1.3 * ElbowOfAMake::allowed_permille);
  EXPECT_LT(elbow.too_hard_s(), 0.3) << "100 ms, the quick stop, and standing still for 50 ms";
  EXPECT_TRUE(elbow.commissioning().without_power());
  EXPECT_FALSE(elbow.bench().any_powered());
  EXPECT_FALSE(elbow.commissioning().found()[2]);
}

// A joint that meets something behind its stop. Its drive tells its whole rated torque, as one presses whose limit is its maker's affair.
struct PressesLater {
  const char* name;
  std::size_t joint;
  Commissioning::State in;
  const char* why;
};
class CommissioningThatPressesTooHard : public testing::TestWithParam<PressesLater> {};
INSTANTIATE_TEST_SUITE_P(
    Later, CommissioningThatPressesTooHard,
    testing::Values(PressesLater{"ClosingTheJaw", 4, Commissioning::State::backing_off, "jaw: something is between its fingers"},
                    PressesLater{"OnItsWayBack", 0, Commissioning::State::backing_off, "slew: it presses with 100 % of its rated torque"},
                    PressesLater{"WhileItsFrictionIsFound", 0, Commissioning::State::rubbing,
                                 "slew: it presses with 100 % of its rated torque"}),
    [](const testing::TestParamInfo<PressesLater>& test) { return test.param.name; });

TEST_P(CommissioningThatPressesTooHard, IsStoppedAndTheJawOpens) {
  const PressesLater& later = GetParam();
  constexpr int told_permille = 1000, pressing_ticks = 60;
  Bench bench(somewhere);
  Commissioning::Config config = bench.config();
  config.joints = {};
  config.joints[later.joint] = true;
  Commissioning commissioning(config);
  int ticks = 0;
  double met_rad = 0;
  bench.set_ear([&](CanFrame& frame) {
    if (frame.id != 0x180u + can_map::drive_nodes[later.joint] || commissioning.state() != later.in || ticks >= pressing_ticks) return;
    if (ticks++ == 0) met_rad = bench.angles()[later.joint];
    if (later.joint == 4 && ticks > 30) return;  // it opens: nothing presses any more
    frame.data[6] = told_permille & 0xFF;
    frame.data[7] = told_permille >> 8;
  });
  bench.run(commissioning);
  EXPECT_EQ(commissioning.state(), Commissioning::State::failed);
  EXPECT_NE(commissioning.failure().find(later.why), std::string_view::npos) << commissioning.failure();
  EXPECT_LT(std::abs(bench.angles()[later.joint] - met_rad), 0.2) << "within some 100 ms";
  EXPECT_FALSE(bench.any_powered());
}

}  // namespace
}  // namespace lf::test
