// What an answer promises, whatever is asked of whatever arm: ik_result.hpp and numeric_ik.hpp, at random.
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/arm_chain/plain_kinematics.hpp"
#include "tests/unit/arm_chain/protocol.hpp"
#include "tests/unit/arm_chain/random_arms.hpp"

namespace lf::chain {
namespace {

constexpr std::uint64_t seed = 20261202;

struct Question {
  IkTask task;
  JointValues seed;
  NumericIkConfig config;
};

// Reachable, too far, turned away, past a limit; from within the limits, from outside, from nowhere.
class Questions {
 public:
  Questions(const RealArm& arm, std::uint64_t from) : chain_(chain_of(arm)), judge_(arm), random_(chain_, from) {}

  Question next() {
    Question out;
    JointValues q = random_.next();
    if (pick(3) == 0) q[pick(static_cast<int>(chain_.size()))] += random_.uniform(-0.5, 0.5);
    out.task = task_of(masks[pick(6)], judge_.pose(q));
    if (pick(4) == 0) out.task.base_from_tool.translation() *= random_.uniform(0, 3);
    if (pick(4) == 0) out.task.base_from_tool.rotate(Eigen::AngleAxisd(random_.uniform(-pi, pi), Vec3::UnitY()));
    out.seed = pick(2) == 0 ? random_.near(q, 0.2) : random_.next();
    if (pick(3) == 0) out.seed[pick(static_cast<int>(chain_.size()))] += random_.uniform(-2, 2);
    constexpr double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e7, 1e300};
    if (pick(12) == 0) out.seed[pick(8)] = bad[pick(4)];
    if (pick(20) == 0) out.task.base_from_tool.translation().x() = bad[pick(4)];
    out.config.max_restarts = static_cast<std::uint32_t>(pick(3) == 0 ? 0 : pick(20));
    out.config.random_seed = static_cast<std::uint64_t>(pick(1000));
    out.config.stay = pick(3) == 0;
    return out;
  }

 private:
  int pick(int count) { return static_cast<int>(random_.uniform(0, count)); }

  Chain chain_;
  PlainKinematics judge_;
  RandomPostures random_;
};

std::vector<RealArm> many_arms() {
  std::vector<RealArm> arms = real_arms();
  for (const Make make : makes) {
    RandomArms made(make, seed);
    for (int n = 0; n < 6; ++n) arms.push_back(made.next());
  }
  return arms;
}

// The header's words on q, written anew.
JointValues harmless(const RealArm& arm, const JointValues& from) {
  JointValues out = JointValues::Zero();
  int i = 0;
  for (const UrdfJoint& joint : arm.joints) {
    if (joint.kind == UrdfJoint::Kind::fixed) continue;
    const bool limited = joint.kind != UrdfJoint::Kind::continuous;
    const bool is_number = std::isfinite(from[i]) && std::abs(from[i]) <= 1e6;
    out[i] = is_number ? from[i] : limited ? (joint.lower + joint.upper) / 2 : 0;
    if (limited) out[i] = std::clamp(out[i], joint.lower, joint.upper);
    ++i;
  }
  return out;
}

// The largest of a joint; a slide's in units of the chain's lever.
double travel(const RealArm& arm, double lever_m, const JointValues& from, const JointValues& to) {
  double most = 0;
  int i = 0;
  for (const UrdfJoint& joint : arm.joints) {
    if (joint.kind == UrdfJoint::Kind::fixed) continue;
    most = std::max(most, std::abs(to[i] - from[i]) / (joint.kind == UrdfJoint::Kind::prismatic ? lever_m : 1));
    ++i;
  }
  return most;
}

void judge(const RealArm& arm, const Chain& chain, const Question& asked, const IkResult& result) {
  ASSERT_TRUE(result.q.allFinite() && within_limits(chain, result.q)) << result.q.transpose();
  if (!asked.seed.allFinite()) {
    ASSERT_EQ(result.travel_rad, std::numeric_limits<double>::infinity()) << "no motion is known to be short";
  } else {
    ASSERT_NEAR(result.travel_rad, travel(arm, chain.lever_m(), asked.seed, result.q), 1e-9 * (1 + result.travel_rad));
  }
  ASSERT_EQ(result.jump, result.travel_rad > jump_rad);
  const bool number = asked.task.valid() && asked.seed.cwiseAbs().maxCoeff() <= 1e6 && asked.seed.allFinite();
  ASSERT_EQ(result.outcome == IkOutcome::not_a_number, !number);
  if (result.ok()) {
    ASSERT_TRUE(PlainKinematics(arm).fulfils(asked.task, result.q));
    ASSERT_EQ(result.nearest, result.q);
    ASSERT_FALSE(asked.config.stay && result.jump);
    return;
  }
  ASSERT_EQ(result.q, harmless(arm, asked.seed)) << name(result.outcome);
  if (result.outcome == IkOutcome::joint_limit) {
    ASSERT_GT(result.excess, 0);
    ASSERT_NEAR(std::abs(chain.excess(static_cast<std::size_t>(result.joint), result.nearest[result.joint])), result.excess, 1e-12);
    ASSERT_TRUE(PlainKinematics(arm).fulfils(asked.task, result.nearest));
  }
  if (result.outcome == IkOutcome::out_of_reach) {
    IkTask position = asked.task;
    position.axis = position.roll = false;
    position.position_tolerance_m += result.excess + 1e-9;
    ASSERT_GT(result.excess, 0);
    ASSERT_TRUE(PlainKinematics(arm).fulfils(position, result.nearest));
  }
  if (result.outcome == IkOutcome::jump_needed) {
    ASSERT_TRUE(asked.config.stay);
    ASSERT_TRUE(PlainKinematics(arm).fulfils(asked.task, result.nearest) && within_limits(chain, result.nearest));
    ASSERT_NEAR(result.excess, travel(arm, chain.lever_m(), asked.seed, result.nearest) - jump_rad, 1e-9);
  }
}

// With each way of dividing the work. `begin(solver, question)`, `advance(solver, iterations)`.
template <class Solver, class Begin, class Advance>
void expect_divisible(const Question& asked, std::uint32_t most, const Begin& begin, const Advance& advance) {
  Solver whole, by_one, by_seven;
  begin(whole, asked);
  advance(whole, most);
  const IkResult& result = whole.result();
  ASSERT_NE(whole.status(), IkStatus::running) << "more iterations than it is said to take: " << most;
  ASSERT_LE(result.iterations, most);
  std::uint32_t calls = 0;
  begin(by_one, asked);
  for (; by_one.status() == IkStatus::running; ++calls) advance(by_one, 1);
  ASSERT_EQ(calls, result.iterations) << "each is counted";
  begin(by_seven, asked);
  for (calls = 0; by_seven.status() == IkStatus::running; ++calls) advance(by_seven, 7);
  ASSERT_EQ(calls, (result.iterations + 6) / 7);
  for (const IkResult& other : {by_one.result(), by_seven.result()}) {
    ASSERT_EQ(other.outcome, result.outcome);
    ASSERT_EQ(other.q, result.q);
    ASSERT_EQ(other.nearest, result.nearest);
    ASSERT_EQ(other.excess, result.excess);
    ASSERT_EQ(other.iterations, result.iterations);
  }
}

TEST(IkContract, HoldsForEverySolverAtRandom) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::array<int, 8> outcomes{};
  for (const RealArm& arm : many_arms()) {
    const Chain chain = chain_of(arm);
    Questions questions(arm, seed);
    for (int k = 0; k < 40; ++k) {
      SCOPED_TRACE(arm.name + ", question " + std::to_string(k));
      const Question asked = questions.next();
      Ik ik(chain);
      ik.begin(asked.task, asked.seed, asked.config);
      ASSERT_TRUE(within_limits(chain, ik.result().q)) << "before there is an answer";
      const IkResult& chosen = ik.solve(asked.task, asked.seed, asked.config);
      ASSERT_NO_FATAL_FAILURE(judge(arm, chain, asked, chosen));
      ++outcomes[static_cast<std::size_t>(chosen.outcome)];
      NumericIk numeric;
      numeric.begin(chain, asked.task, asked.seed, asked.config);
      ASSERT_TRUE(within_limits(chain, numeric.result().q)) << "before there is an answer";
      ASSERT_NO_FATAL_FAILURE(judge(arm, chain, asked, numeric.solve(chain, asked.task, asked.seed, asked.config)));
    }
  }
  for (std::size_t i = 0; i < outcomes.size(); ++i) RecordProperty(name(static_cast<IkOutcome>(i)), outcomes[i]);
  for (const IkOutcome each : {IkOutcome::solved, IkOutcome::not_a_number, IkOutcome::out_of_reach, IkOutcome::orientation_unreachable,
                               IkOutcome::joint_limit, IkOutcome::jump_needed, IkOutcome::gave_up})
    EXPECT_GT(outcomes[static_cast<std::size_t>(each)], 3) << name(each);
}

TEST(IkContract, CountsEachIterationAndTakesNoMoreThanItSays) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  for (const RealArm& arm : many_arms()) {
    const Chain chain = chain_of(arm);
    Questions questions(arm, seed + 1);
    for (int k = 0; k < 12; ++k) {
      SCOPED_TRACE(arm.name + ", question " + std::to_string(k));
      const Question asked = questions.next();
      ASSERT_NO_FATAL_FAILURE(expect_divisible<NumericIk>(
          asked, NumericIk::most_iterations(asked.config),
          [&](NumericIk& ik, const Question& of) { ik.begin(chain, of.task, of.seed, of.config); },
          [&](NumericIk& ik, std::uint32_t iterations) { ik.advance(chain, iterations); }));
      ASSERT_NO_FATAL_FAILURE(expect_divisible<Ik>(
          asked, Ik::most_iterations(asked.config),
          [&](Ik& ik, const Question& of) {
            ik = Ik(chain);
            ik.begin(of.task, of.seed, of.config);
          },
          [](Ik& ik, std::uint32_t iterations) { ik.advance(iterations); }));
    }
  }
}

// The long form, 10,000 poses, is `lanternfish bench chain`.
TEST(IkContract, SolvesTasksThatAskForLessThanAPose) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  for (const RealArm& arm : real_arms()) {
    const PlainKinematics judge(arm);
    Ik ik(chain_of(arm));
    RandomPostures random(ik.chain(), seed + 4);
    for (const Mask& mask : {masks[1], masks[2], masks[3]}) {
      int solved = 0, wrong = 0;
      for (int k = 0; k < 500; ++k) {
        const IkTask task = task_of(mask, judge.pose(random.next()));
        const IkResult& result = ik.solve(task, ik.chain().middle());
        solved += result.ok() ? 1 : 0;
        wrong += judge.fulfils(task, result.q) && within_limits(ik.chain(), result.q) ? 0 : 1;
      }
      EXPECT_EQ(solved, 500) << arm.name << ", " << mask.name;
      EXPECT_EQ(wrong, 0) << arm.name << ", " << mask.name;
    }
  }
}

TEST(IkContract, MeasuresTheTravelFromWhereTheArmIs) {
  const RealArm arm = oberon7();
  Ik ik(chain_of(arm));
  NumericIk numeric;
  JointValues at;
  at << 1.04719758, 0.3, -0.6, 0.4, 0.5, 0.2, 0, 0;  // joint 1 at its limit
  const IkTask task = task_of(masks[0], ik.chain().base_from_tool(at));
  JointValues start = at;
  for (const double past_rad : {0.1, 0.4}) {
    start[0] = at[0] + past_rad;
    for (const IkResult& result : {ik.solve(task, start), numeric.solve(ik.chain(), task, start)}) {
      ASSERT_TRUE(result.ok());
      EXPECT_NEAR(result.travel_rad, past_rad, 1e-6);
      EXPECT_EQ(result.jump, past_rad > jump_rad);
    }
    for (const IkResult& result : {ik.solve(task, start, {.stay = true}), numeric.solve(ik.chain(), task, start, {.stay = true})})
      EXPECT_EQ(result.ok(), past_rad < jump_rad) << "an arm that far outside cannot stay";
  }
}

// The seed's elbow is up, and the target's posture with the elbow up is past a limit: the other branch is an answer, but not for an arm that is to stay.
TEST(IkContract, StaysOnItsBranchOrRefuses) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  for (const RealArm& arm : {oberon7(), predator(), ur5(), open_manipulator_x()}) {
    Ik ik(chain_of(arm));
    NumericIk numeric;
    RandomPostures random(ik.chain(), seed + 2);
    int jumped = 0, stayed = 0;
    for (int k = 0; k < 300; ++k) {
      const IkTask task = task_of(masks[0], ik.chain().base_from_tool(random.next()));
      const JointValues start = random.next();
      const IkResult free = ik.solve(task, start, {.max_restarts = 0});
      ASSERT_TRUE(free.ok()) << "a closed form needs no restart";
      const IkResult bound = ik.solve(task, start, {.stay = true});
      ASSERT_EQ(bound.ok(), !free.jump);
      ASSERT_EQ(bound.outcome, free.jump ? IkOutcome::jump_needed : IkOutcome::solved);
      if (free.jump) {
        ASSERT_EQ(bound.nearest, free.q) << "the nearest of all";
        ASSERT_EQ(bound.q, start);
      }
      (free.jump ? jumped : stayed) += 1;
      const IkResult& by_descent = numeric.solve(ik.chain(), task, start, {.stay = true});
      ASSERT_FALSE(by_descent.ok() && by_descent.jump);
    }
    EXPECT_GT(jumped, 200) << arm.name;
  }
}

// As a path's points are: from 0.1 rad away, on every arm.
TEST(IkContract, StayingLosesNoPathsPoint) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  for (const RealArm& arm : real_arms()) {
    Ik ik(chain_of(arm));
    NumericIk numeric;
    RandomPostures random(ik.chain(), seed + 3);
    int lost = 0, needed = 0;
    for (int k = 0; k < 1000; ++k) {
      const JointValues q = random.next();
      const IkTask task = task_of(masks[0], PlainKinematics(arm).pose(q));
      const JointValues start = random.near(q, 0.1);
      lost += ik.solve(task, start, {.stay = true}).ok() ? 0 : 1;
      needed += numeric.solve(ik.chain(), task, start, {.stay = true}).ok() ? 0 : 1;
    }
    EXPECT_EQ(lost, 0) << arm.name;
    EXPECT_LE(needed, 2) << arm.name << ", numeric: beside a singular posture";
  }
}

}  // namespace
}  // namespace lf::chain
