#include "hal/config/nearest.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "shared/input_error.hpp"

namespace lf::config {

TEST(Nearest, CountsEditsAsDamerauLevenshtein) {
  EXPECT_EQ(edit_distance("", ""), 0);
  EXPECT_EQ(edit_distance("abc", "abc"), 0);
  EXPECT_EQ(edit_distance("abc", ""), 3);
  EXPECT_EQ(edit_distance("friction", "fricton"), 1);
  EXPECT_EQ(edit_distance("strat", "start"), 1);     // a swap is one edit
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);  // the textbook's example
  EXPECT_EQ(edit_distance("Valve", "valve"), 0);
}

TEST(Nearest, CountsUpToAMostAsItDoesWithout) {
  const std::vector<std::string> words{"",      "a",    "ab",     "ba",      "valve",       "vavle",       "VALVES",
                                       "lamps", "lamp", "kitten", "sitting", "friction_nm", "viscous_nm_s"};
  for (const std::string& a : words) {
    for (const std::string& b : words) {
      for (int most = 0; most < 14; ++most)
        EXPECT_EQ(edit_distance(a, b, most), std::min(edit_distance(a, b), most + 1)) << a << " " << b << " " << most;
    }
  }
}

TEST(Nearest, IsSymmetricAndObeysTheTriangleInequality) {
  const std::vector<std::string> words{"", "a", "valve", "vavle", "lamps", "lamp", "friction_nm", "viscous_nm_s"};
  for (const std::string& a : words) {
    for (const std::string& b : words) {
      EXPECT_EQ(edit_distance(a, b), edit_distance(b, a)) << a << " " << b;
      for (const std::string& c : words)
        EXPECT_LE(edit_distance(a, c), edit_distance(a, b) + edit_distance(b, c)) << a << " " << b << " " << c;
    }
  }
}

TEST(Nearest, SuggestsWhatWasProbablyMeantAndNothingElse) {
  const std::vector<std::string> names{"valve", "water", "lamps", "camera", "laser"};
  EXPECT_EQ(suggestion("vavle", names), "; did you mean 'valve'?");
  EXPECT_EQ(suggestion("cammera", names), "; did you mean 'camera'?");
  EXPECT_EQ(suggestion("lazer", names), "; did you mean 'laser'?");
  EXPECT_EQ(suggestion("hydraulics", names), "");
  EXPECT_EQ(suggestion("x", {}), "");
  EXPECT_EQ(suggestion("water", {"laser"}), "") << "two of five letters are another word";
}

// Keys end in their units, which are what a user leaves out.
TEST(Nearest, ANameThatGoesOnWhereTheWordEndsIsMeant) {
  const std::vector<std::string> names{"attention",    "attenuation_per_m", "sweep_speed_rad_s",
                                       "sweep_speeds", "stop_min_deg",      "stop_max_deg"};
  EXPECT_EQ(suggestion("attenuation", names), "; did you mean 'attenuation_per_m'?");
  EXPECT_EQ(suggestion("sweep_speed", names), "; did you mean 'sweep_speed_rad_s'?");
  EXPECT_EQ(suggestion("stop", names), "; did you mean 'stop_min_deg'?");
  EXPECT_EQ(suggestion("sw", names), "") << "two letters are too few";
}

TEST(Nearest, ARefusalNamesTheNearestOrTheFewThatThereAre) {
  const auto refusal = [](const std::string& given, const std::vector<std::string>& known) -> std::string {
    try {
      check_names({given}, known, "--channel");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::vector<std::string> few{"grey", "red", "green"};
  EXPECT_EQ(refusal("red", few), "");
  EXPECT_EQ(refusal("greeen", few), "--channel: there is no 'greeen'; did you mean 'green'?");
  EXPECT_EQ(refusal("purple", few), "--channel: there is no 'purple'; it is one of grey, red or green");
  EXPECT_EQ(refusal("purple", std::vector<std::string>(80, "something")), "--channel: there is no 'purple'");
}

}  // namespace lf::config
