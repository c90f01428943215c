#include "host_sim/campaign/seeds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/input_error.hpp"

namespace lf::campaign {
namespace {

using testing::HasSubstr;

std::string refusal_of(const std::string& text) {
  try {
    (void)parse_seeds(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Seeds, ListsAndRangesAreRead) {
  EXPECT_EQ(parse_seeds("7"), (std::vector<std::uint64_t>{7}));
  EXPECT_EQ(parse_seeds("1-4"), (std::vector<std::uint64_t>{1, 2, 3, 4}));
  EXPECT_EQ(parse_seeds("9,1,2,5-7"), (std::vector<std::uint64_t>{1, 2, 5, 6, 7, 9}));
  EXPECT_EQ(parse_seeds("18446744073709551615"), (std::vector<std::uint64_t>{18446744073709551615u}));
  EXPECT_EQ(parse_seeds("18446744073709551614-18446744073709551615").size(), 2u);
}

TEST(Seeds, WhatIsNoneIsRefusedByName) {
  EXPECT_THAT(refusal_of("1,x,3"), HasSubstr("not 'x' in '1,x,3'"));
  EXPECT_THAT(refusal_of("1,,3"), HasSubstr("not '' in '1,,3'"));
  EXPECT_THAT(refusal_of("1,"), HasSubstr("not '' in '1,'"));
  EXPECT_THAT(refusal_of(""), HasSubstr("not ''"));
  EXPECT_THAT(refusal_of("1--3"), HasSubstr("not '1--3'"));
  EXPECT_THAT(refusal_of("-3"), HasSubstr("not '-3'"));
  EXPECT_THAT(refusal_of("1.5"), HasSubstr("not '1.5'"));
  EXPECT_THAT(refusal_of("18446744073709551616"), HasSubstr("not '18446744073709551616'"));
  EXPECT_THAT(refusal_of("2,9-7"), HasSubstr("9-7 in '2,9-7': the first is above the last"));
  EXPECT_THAT(refusal_of("1-5,3"), HasSubstr("seed 3 is given twice"));
}

TEST(Seeds, MoreThanAMillionAreRefusedBeforeTheyAreCounted) {
  EXPECT_THAT(refusal_of("0-18446744073709551615"), HasSubstr("more than a million"));
  EXPECT_THAT(refusal_of("1-600000,600001-1200000"), HasSubstr("more than a million"));
  EXPECT_EQ(parse_seeds("1-1000000").size(), most_runs);
}

}  // namespace
}  // namespace lf::campaign
