// What people read of a step that failed.
#include "firmware/mission/step_failure.hpp"
#include "tests/unit/all_named.hpp"

namespace lf {
namespace {

constexpr std::size_t failures = 33;

TEST(Names, OfEachReasonForWhichAStepFails) {
  test::expect_all_named<StepFailure>(failures, [](StepFailure f) { return name(f); });
}

// A remedy is a sentence or several, and names what can be looked at.
TEST(Names, RemediesAreSentences) {
  std::size_t with_one = 0;
  for (std::size_t i = 0; i < failures; ++i) {
    const std::string text = remedy(static_cast<StepFailure>(i));
    if (text.empty()) continue;
    ++with_one;
    EXPECT_TRUE(text.ends_with('.')) << text;
    EXPECT_EQ(text.find("  "), std::string::npos) << text;
  }
  EXPECT_GE(with_one, 25u);
  EXPECT_STREQ(remedy(static_cast<StepFailure>(200)), "");
}

}  // namespace
}  // namespace lf
