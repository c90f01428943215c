// Answers that a script must not take for sure ones: the reason on stderr and in the JSON, and exit status 1.
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
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

// The picture of one frame before: the stripe has moved by less than its width, or by some of them.
TEST_F(Doubts, AnOffPictureOfOneFrameBefore) {
  const std::string on = stripe("on.png", 2, 120, 1);
  for (const double moved_px : {2.0, 3.0, 5.0, 8.0, 12.0, 14.0, -3.0, -8.0})
    expect_doubt("peaks " + on + " --off " + stripe("before.png", 2, 120, 1, moved_px), "--off seems to have the laser, too");
}

// Real pairs, of automatic exposures, in the laser's colour.
TEST_F(Doubts, NoOffPictureOfRealPairsIsTakenForOneWithTheLaser) {
  for (const char* pair : {"01", "02", "03", "04", "05", "06", "07", "08", "09", "10"}) {
    const std::string name = std::string(LANTERNFISH_SOURCE_DIR "/tests/data/laser_on_off_pairs/pair") + pair;
    EXPECT_THAT(run("peaks " + name + "_on.jpg --off " + name + "_off.jpg --channel red").err, ::testing::Not(HasSubstr("--off seems")))
        << pair;
  }
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

TEST_F(Doubts, ReachSurveysTheScenariosArm) {
  std::string urdf = text_of(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf");
  const auto survey = [&](const std::string& name) { return run("reach --json --draws 1 --set arm.urdf=" + file(name, urdf)); };
  const std::string same = survey("same.urdf").out;
  EXPECT_EQ(same, run("reach --json --draws 1").out);
  const std::string tool = "xyz=\"0 0 0.1485\"";
  ASSERT_NE(urdf.find(tool), std::string::npos);
  urdf.replace(urdf.find(tool), tool.size(), "xyz=\"0 0 0.1700\"");  // longer by 21.5 mm
  const Said longer = survey("longer.urdf");
  EXPECT_NE(longer.out, same);
  EXPECT_NE(longer.status, 2) << longer.err;
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
  EXPECT_THAT(said.err, HasSubstr("is the laser in this picture and in this channel, and does its line run across them (--axis)?"));
  EXPECT_THAT(said.err, ::testing::Not(HasSubstr("--off")));
}

// A marker of 0.1 m, turned by 30 degrees about its vertical, seen from 0.4 m through a wide lens: its far side is 12 % smaller. From 400 m through a lens a
// thousand times longer it looks the same but for a thousandth of that, 0.01 px, and the tilt to the other side explains it as well.
TEST_F(Doubts, AMarkerWhoseTiltIsUnsure) {
  apriltag_family_t* const family = tag36h11_create();
  image_u8_t* const tag = apriltag_to_image(family, 7);
  for (const double times : {1.0, 1000.0}) {
    SCOPED_TRACE(times);
    constexpr int width = 640, height = 480;
    const double focal_px = 600 * times, away_m = 0.4 * times, size_m = 0.1, tilt_rad = 0.5236;
    const double cells = tag->width, cell_m = size_m / family->width_at_border;
    std::vector<std::uint8_t> pixels;
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        double grey = 0;
        for (int k = 0; k < 64; ++k) {  // samples of the pixel
          const double x = (u + (k % 8 + 0.5) / 8 - 0.5 - 320) / focal_px, y = (v + (k / 8 + 0.5) / 8 - 0.5 - 240) / focal_px;
          // Along the ray z (x, y, 1) the plane's horizontal a has z x = a cos, z = away + a sin.
          const double a = away_m * x / (std::cos(tilt_rad) - x * std::sin(tilt_rad));
          const double b = y * (away_m + a * std::sin(tilt_rad));
          const double column = a / cell_m + cells / 2, row = b / cell_m + cells / 2;
          const bool inside = column >= 0 && row >= 0 && column < cells && row < cells;
          grey += inside ? tag->buf[static_cast<int>(row) * tag->stride + static_cast<int>(column)] : 200;
        }
        pixels.push_back(static_cast<std::uint8_t>(std::lround(30 + 0.7 * grey / 64)));
      }
    }
    const std::vector<std::uint8_t> png = record::encode_png(ImageView{pixels.data(), width, height, width});
    const std::string picture = file("tag.png", std::string(png.begin(), png.end()));
    const std::string focal = std::to_string(focal_px);
    const std::string camera =
        file("camera.yaml", "image_width: 640\nimage_height: 480\ncamera_matrix: {rows: 3, cols: 3, data: [" + focal + ", 0, 320, 0, " +
                                focal + ", 240, 0, 0, 1]}\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n");
    const Said said = run("markers " + picture + " --camera " + camera + " --size-m 0.1 --json");
    const Json markers = Json::parse(said.out)[0]["markers"];
    ASSERT_EQ(markers.size(), 1U) << said.err;
    EXPECT_EQ(markers[0]["id"], 7);
    EXPECT_EQ(said.status, times > 1 ? 1 : 0) << markers[0];
    if (times > 1) {
      EXPECT_THAT(said.err, HasSubstr("tag.png: doubtful: frame 0: of id 7 a second pose, "));
      EXPECT_THAT(markers[0]["doubts"].dump(), HasSubstr("its tilt is unsure"));
    } else {
      EXPECT_EQ(said.err, "");
      EXPECT_TRUE(markers[0]["doubts"].empty());
      EXPECT_NEAR(markers[0]["pose"]["translation_m"][2], away_m, 0.01 * away_m);
    }
  }
  std::free(tag->buf);
  std::free(tag);
  tag36h11_destroy(family);
}

TEST_F(Doubts, NoMarkerIsAFailureWithItsReason) {
  const Said said = run("markers " + stripe("bare.png", 2, 120, 1));
  EXPECT_EQ(said.status, 1);
  EXPECT_THAT(said.out, HasSubstr("0 markers in 1 frame"));
  for (const char* word : {"no marker of family 36h11", "--family", "--margin", "--decimate 1.5 or 2 (now 1)"})
    EXPECT_THAT(said.err, HasSubstr(word));
  EXPECT_THAT(run("markers --decimate 2 " + stripe("bare.png", 2, 120, 1)).err, HasSubstr("small markers with --decimate 1 (now 2)"));
  EXPECT_EQ(run("markers --decimate 0 " + stripe("bare.png", 2, 120, 1)).status, 2);
}

}  // namespace

}  // namespace lf::app
