// Answers that a script must not take for sure ones: the reason on stderr and in the JSON, and exit status 1.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "host_sim/record/png.hpp"
#include "tests/unit/app/program.hpp"

namespace lf::app {

namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

class Doubts : public Program {
 protected:
  // A Gaussian stripe at v = 80.3 + 0.02 u over a grey of 20, with noise.
  std::string stripe(const std::string& name, double sigma_px, double height_grey, double noise_grey, double lower_px = 0) const {
    constexpr int width = 300, height = 200;
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, noise_grey);
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * height);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        const double off = (v - 80.3 - lower_px - 0.02 * u) / sigma_px;
        const double grey = 20 + height_grey * std::exp(-0.5 * off * off) + (noise_grey > 0 ? noise(random) : 0);
        pixels[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)] =
            static_cast<std::uint8_t>(std::lround(std::min(255.0, std::max(0.0, grey))));
      }
    }
    const std::vector<std::uint8_t> png = record::encode_png(ImageView{pixels.data(), width, height, width});
    return file(name, std::string(png.begin(), png.end()));
  }
  // A plane z = 0.5 + 0.25 x of one square metre, in `unit` metres, with noise.
  std::string plane(const std::string& name, double unit, double noise_m, double width_m = 1, int points = 5000) const {
    std::mt19937 random(6);
    std::normal_distribution<double> noise(0, noise_m);
    std::uniform_real_distribution<double> place(0, 1);
    std::string csv = "x,y,z\n";
    for (int i = 0; i < points; ++i) {
      const double x = place(random), y = width_m * place(random);
      csv +=
          std::to_string(unit * x) + "," + std::to_string(unit * y) + "," + std::to_string(unit * (0.5 + 0.25 * x + noise(random))) + "\n";
    }
    return file(name, csv);
  }
  void expect_doubt(const std::string& command, const std::string& why) const {
    SCOPED_TRACE(command);
    const Said said = run(command + " --json");
    EXPECT_EQ(said.status, 1) << said.err;
    EXPECT_THAT(said.err, HasSubstr("doubtful: "));
    EXPECT_THAT(said.err, HasSubstr(why));
    EXPECT_THAT(Json::parse(said.out)["doubts"].dump(), HasSubstr(why)) << "and the answer itself is given";
  }
};

// At half its height a Gaussian is 2.355 sigma wide.
TEST_F(Doubts, AStripeThatIsTooWideForItsPeaks) {
  expect_doubt("peaks " + stripe("wide.png", 10, 120, 1), "the stripe is 24 px wide at half its height");
  for (const double sigma_px : {1.0, 2.0, 4.0}) {
    const Said said = run("peaks " + stripe("sharp.png", sigma_px, 120, 1) + " --json");
    EXPECT_EQ(said.status, 0) << said.err;
    EXPECT_EQ(said.err, "");
    const Json answer = Json::parse(said.out);
    EXPECT_NEAR(answer["stripe_width_px"], 2.355 * sigma_px, 0.1 * 2.355 * sigma_px + 0.2) << sigma_px;
    EXPECT_TRUE(answer["doubts"].empty());
  }
}

// A picture of the laser given as the one without it: its stripe is dark, and as deep.
TEST_F(Doubts, AnOffPictureThatHasTheLaserToo) {
  const std::string on = stripe("on.png", 2, 120, 1);
  const std::string off = stripe("off.png", 2, 120, 1, 40);
  expect_doubt("peaks " + on + " --off " + off, "--off seems to have the laser, too");
  EXPECT_EQ(run("peaks " + on + " --off " + stripe("dark.png", 2, 0, 1)).status, 0);
  expect_doubt("peaks " + on + " --off " + on, "peaks in 0 of 300 lines");
}

TEST_F(Doubts, PeaksThatNoiseHasScattered) {
  expect_doubt("peaks " + stripe("noisy.png", 4, 45, 14), "the peaks scatter by ");
  EXPECT_EQ(run("peaks " + stripe("quiet.png", 2, 120, 4)).status, 0);
}

TEST_F(Doubts, ACloudInMillimetres) {
  expect_doubt("plane " + plane("mm.csv", 1000, 0.0005), "is it in millimetres?");
  expect_doubt("plane " + plane("exact.csv", 1000, 0), "is it in millimetres?");
  EXPECT_EQ(run("plane " + plane("m.csv", 1, 0.0005)).status, 0);
}

TEST_F(Doubts, APlaneOfAFewOfItsPoints) {
  const Said said = run("plane " + plane("blot.csv", 1, 0.3) + " --json");
  EXPECT_EQ(said.status, 1);
  EXPECT_THAT(said.err, ::testing::ContainsRegex("only [0-9]+ of 5000 points lie within 3 mm of the plane"));
}

// Across a strip of 20 mm points are spread by 20 / sqrt(12) = 5.8 mm. 40 points of 2 mm noise leave the normal 2 / 5.8 / sqrt(40) = 0.055 rad, 3 degrees, and 300 of
// 0.5 mm 0.3 degrees. A strip whose width is a hundredth of its length is no plane at all.
TEST_F(Doubts, APlaneThroughALine) {
  expect_doubt("plane " + plane("strip.csv", 1, 0.002, 0.02, 40), "lie along a line: its normal is known to ");
  EXPECT_EQ(run("plane " + plane("band.csv", 1, 0.0005, 0.02, 300)).status, 0);
}

TEST_F(Doubts, ReachRefusesAnotherArmThanTheCores) {
  std::string urdf = text_of(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf");
  EXPECT_EQ(run("reach --draws 1 --set arm.urdf=" + file("same.urdf", urdf)).status, 0);
  const std::size_t at = urdf.find("upper=\"0.5488\"");
  ASSERT_NE(at, std::string::npos);
  const Said said = run("reach --draws 1 --out other.png --set arm.urdf=" + file("other.urdf", urdf.replace(at, 14, "upper=\"0.4488\"")));
  EXPECT_EQ(said.status, 2);
  EXPECT_THAT(said.err, HasSubstr("'arm.urdf' names another arm than the control core's"));
  EXPECT_THAT(said.err, HasSubstr("the limits of slew differ"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "other.png"));
}

TEST_F(Doubts, AButtonOverTheMarkerIsRefusedByName) {
  const std::string over = " --set 'panel.buttons_m=[[-0.17, 0.072], [0, 0.186], [0.067, 0.141]]'";
  for (const char* command : {"scenarios default", "reach default --draws 1", "run default"}) {
    const Said said = run(command + over);
    EXPECT_EQ(said.status, 2) << command;
    EXPECT_THAT(said.err, HasSubstr("the left button covers the marker's plate")) << command;
  }
}

TEST_F(Doubts, ReachTellsAButtonThatTheHandleIsInTheWayOf) {
  expect_doubt("reach --draws 50 --set 'panel.buttons_m=[[-0.067, 0.141], [0, 0.095], [0.067, 0.141]]'",
               "mm into the handle's circle: at some angles of the handle the arm touches it");
  const Said plain = run("reach --draws 50");
  EXPECT_EQ(plain.status, 0) << plain.err;
  EXPECT_EQ(plain.err, "");
}

TEST_F(Doubts, ReachTellsAPlaceThatSomeDockingErrorsLeaveOutOfReach) {
  expect_doubt("reach --draws 200 --set 'panel.buttons_m=[[-0.067, 0.141], [0, 0.186], [0.17, 0.141]]'",
               "the right button is out of reach at ");
}

// Without a picture of the same scene nothing is said of one.
TEST_F(Doubts, PeaksOfOnePictureSayNothingOfAnother) {
  const Said said = run("peaks " + stripe("one.png", 2, 0, 1));
  EXPECT_EQ(said.status, 1);
  EXPECT_THAT(said.err, HasSubstr("is the laser in this picture and in this channel?"));
  EXPECT_THAT(said.err, ::testing::Not(HasSubstr("--off")));
}

TEST_F(Doubts, NoMarkerIsAFailureWithItsReason) {
  const Said said = run("markers " + stripe("bare.png", 2, 120, 1));
  EXPECT_EQ(said.status, 1);
  EXPECT_THAT(said.out, HasSubstr("0 markers in 1 frame"));
  for (const char* word : {"no marker of family 36h11", "--family", "--margin", "--decimate 1 (now "})
    EXPECT_THAT(said.err, HasSubstr(word));
}

}  // namespace

}  // namespace lf::app
