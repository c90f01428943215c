#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "host_sim/record/png.hpp"
#include "shared/input_error.hpp"

namespace lf::record {
namespace {

std::span<const std::uint8_t> bytes_of(std::string_view text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

// RFC 4648, section 10.
TEST(Base64, GivesTheVectorsOfTheRfc) {
  EXPECT_EQ(base64({}), "");
  EXPECT_EQ(base64(bytes_of("f")), "Zg==");
  EXPECT_EQ(base64(bytes_of("fo")), "Zm8=");
  EXPECT_EQ(base64(bytes_of("foo")), "Zm9v");
  EXPECT_EQ(base64(bytes_of("foob")), "Zm9vYg==");
  EXPECT_EQ(base64(bytes_of("fooba")), "Zm9vYmE=");
  EXPECT_EQ(base64(bytes_of("foobar")), "Zm9vYmFy");
}

TEST(Png, KeepsEveryPixelOfAGreyImageWhoseRowsHavePadding) {
  std::vector<std::uint8_t> pixels(7 * 16);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * 37);
  const cv::Mat decoded = cv::imdecode(encode_png(ImageView{pixels.data(), 13, 7, 16}), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(decoded.type(), CV_8UC1);
  ASSERT_EQ(decoded.size(), cv::Size(13, 7));
  for (int v = 0; v < 7; ++v) {
    for (int u = 0; u < 13; ++u) EXPECT_EQ(decoded.at<std::uint8_t>(v, u), pixels[static_cast<std::size_t>(v * 16 + u)]);
  }
}

TEST(Png, DrawsPeaksRedOverTheGreyImageAndNothingOutsideOfIt) {
  std::vector<std::uint8_t> pixels(20 * 10, 90);
  const std::vector<PixelPoint> peaks{{3.f, 4.2f}, {500.f, 2.f}, {-3.f, -1.f}, {std::nanf(""), 1.f}};
  const RgbImage overlay = overlay_peaks({pixels.data(), 20, 10, 20}, peaks);
  const cv::Mat decoded = cv::imdecode(encode_png(overlay), cv::IMREAD_COLOR);
  const auto red = decoded.at<cv::Vec3b>(4, 3);  // blue, green, red
  EXPECT_GT(red[2], 240);
  EXPECT_LT(red[0], 40);
  int coloured = 0;
  for (int v = 0; v < 10; ++v) {
    for (int u = 0; u < 20; ++u) coloured += decoded.at<cv::Vec3b>(v, u) != cv::Vec3b(90, 90, 90);
  }
  EXPECT_EQ(coloured, 2);
}

TEST(Png, RefusesAnEmptyImage) {
  EXPECT_THROW(encode_png(ImageView{}), InputError);
  EXPECT_THROW(encode_png(RgbImage{}), InputError);
}

}  // namespace
}  // namespace lf::record
