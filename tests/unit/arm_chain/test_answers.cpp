// The same answers on every platform: what one has answered is kept in a file and asked of all. Whether an answer is right, other tests say.
//
// The file is written anew with LANTERNFISH_RECORD_ANSWERS=1: when the solver is another, not when a platform is.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>

#include "firmware/arm/chain/ik.hpp"
#include "tests/unit/arm_chain/protocol.hpp"
#include "tests/unit/arm_chain/real_arms.hpp"

namespace lf::chain {
namespace {

constexpr std::uint64_t seed = 20261129;
constexpr int poses_each = 25;
constexpr double same_rad = 1e-6;  // m, of a slide
const std::string file = LANTERNFISH_TEST_DATA "/arms/answers.csv";

struct Answer {
  std::string name;
  bool solved = false;
  JointValues q = JointValues::Zero();
};

std::vector<Answer> answers() {
  std::vector<Answer> all;
  for (const RealArm& arm : real_arms()) {
    const Chain chain = chain_of(arm);
    RandomPostures random(chain, seed);
    for (std::size_t mask = 0; mask < 4; ++mask) {
      for (int k = 0; k < poses_each; ++k) {
        Ik ik(chain);
        IkTask task = task_of(masks[mask], chain.base_from_tool(random.next()));
        if (k % 5 == 4) task.base_from_tool.translation() *= 3;  // beyond any arm's reach, for most
        const IkResult& result = ik.solve(task, chain.middle());
        all.push_back({arm.name + " " + masks[mask].id + " " + std::to_string(k), result.ok(), result.q});
      }
    }
  }
  return all;
}

void record(const std::vector<Answer>& all) {
  std::ofstream out(file);
  out << "# What Ik answers for poses drawn by tests/unit/arm_chain/test_answers.cpp: arm, task, number, solved, joints.\n"
      << std::setprecision(10);
  for (const Answer& answer : all) out << answer.name << ' ' << answer.solved << ' ' << answer.q.transpose() << '\n';
}

TEST(Answers, AreTheSameToAMillionthOfARadianOnAnyPlatform) {
  const std::vector<Answer> all = answers();
  if (std::getenv("LANTERNFISH_RECORD_ANSWERS") != nullptr) {
    record(all);
    GTEST_SKIP() << "recorded";
  }
  std::ifstream in(file);
  ASSERT_TRUE(in) << file;
  std::size_t row = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    ASSERT_LT(row, all.size());
    const Answer& now = all[row++];
    SCOPED_TRACE(now.name);
    std::istringstream words(line);
    std::string arm, task;
    int number = 0;
    Answer kept;
    words >> arm >> task >> number >> kept.solved;
    for (double& value : kept.q) words >> value;
    ASSERT_TRUE(words) << line;
    ASSERT_EQ(arm + " " + task + " " + std::to_string(number), now.name);
    EXPECT_EQ(kept.solved, now.solved);
    EXPECT_LT((kept.q - now.q).cwiseAbs().maxCoeff(), same_rad) << line;
  }
  EXPECT_EQ(row, all.size());
}

}  // namespace
}  // namespace lf::chain
