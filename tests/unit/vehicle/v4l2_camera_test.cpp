#include "hal/vehicle/v4l2_camera.hpp"

#include <gtest/gtest.h>

#include "tests/unit/vehicle/fake_linux.hpp"

namespace lf::hal {
namespace {

using test::FakeLinux;

V4l2Camera::Config small() {
  V4l2Camera::Config config;
  config.width = 8;
  config.height = 4;
  config.exposure = Duration::from_us(2050);
  config.gain = 7;
  return config;
}

TEST(V4l2Camera, SetsExposureAndGainByHand) {
  FakeLinux linux_;
  V4l2Camera camera(small(), linux_);
  ASSERT_EQ(camera.open(), port_ok);
  const std::vector<std::pair<std::uint32_t, std::int32_t>> expected{
      {V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL}, {V4L2_CID_EXPOSURE_ABSOLUTE, 21}, {V4L2_CID_AUTOGAIN, 0}, {V4L2_CID_GAIN, 7}};
  EXPECT_EQ(linux_.controls, expected);
  EXPECT_TRUE(linux_.streaming);
}

class EveryFormat : public testing::TestWithParam<std::uint32_t> {};

TEST_P(EveryFormat, BecomesGreyAndKeepsTheDriversTime) {
  FakeLinux linux_;
  linux_.camera_format = GetParam();
  V4l2Camera::Config config = small();
  config.stamp_delay = Duration::from_us(500);
  V4l2Camera camera(config, linux_);
  ASSERT_EQ(camera.open(), port_ok);
  linux_.frames.push_back({.sequence = 3, .stamp_ns = 2'000'000'000, .value = 201});
  Image image;
  ASSERT_EQ(camera.receive(image), port_ok);
  ASSERT_TRUE(image.view.valid());
  EXPECT_EQ(image.view.width, 8);
  EXPECT_EQ(image.view.height, 4);
  for (std::int32_t v = 0; v < 4; ++v) {
    for (std::int32_t u = 0; u < 8; ++u) EXPECT_EQ(image.view.at(u, v), 201) << u << "," << v;
  }
  EXPECT_EQ(image.exposure_start.ns(), 2'000'000'000 - 500'000);
  EXPECT_EQ(image.exposure, config.exposure);
  EXPECT_EQ(image.trigger, -1);
  EXPECT_EQ(camera.receive(image), port_empty);
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryFormat, testing::Values(V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_Y10, V4L2_PIX_FMT_Y16, V4L2_PIX_FMT_YUYV));

TEST(V4l2Camera, CountsGapsRepeatsAndBrokenFrames) {
  FakeLinux linux_;
  V4l2Camera camera(small(), linux_);
  ASSERT_EQ(camera.open(), port_ok);
  linux_.frames.push_back({.sequence = 0, .stamp_ns = 1'000'000});
  linux_.frames.push_back({.sequence = 4, .stamp_ns = 2'000'000});                                // 1, 2 and 3 never came
  linux_.frames.push_back({.sequence = 4, .stamp_ns = 2'000'000});                                // again
  linux_.frames.push_back({.sequence = 5, .stamp_ns = 3'000'000, .flags = V4L2_BUF_FLAG_ERROR});  // broken
  linux_.frames.push_back({.sequence = 6, .stamp_ns = 4'000'000, .whole = false});                // cut short
  // Of an open kind of clock, and not of the last second: no time that can be believed.
  linux_.frames.push_back({.sequence = 7, .stamp_ns = 1'700'000'000'000'000'000, .flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN});
  std::vector<std::uint32_t> sequences;
  for (int look = 0; look < 10; ++look) {
    Image image;
    if (camera.receive(image) == port_ok) sequences.push_back(image.sequence);
  }
  ASSERT_EQ(sequences.size(), 3u);
  EXPECT_EQ(sequences[1] - sequences[0], 4u);
  EXPECT_EQ(sequences[2] - sequences[1], 3u);
  EXPECT_EQ(camera.stats().skipped, 3u);
  EXPECT_EQ(camera.stats().repeated, 1u);
  EXPECT_EQ(camera.stats().broken, 2u);
  EXPECT_EQ(camera.stats().stamps_missed, 1u);
  EXPECT_EQ(camera.stats().images, 3u);
}

// A driver or a loopback device may send an old image under a new number. The stamp is the image's, so it tells.
TEST(V4l2Camera, AnImageWithARepeatedTimeStampIsARepeatedOne) {
  for (const std::uint32_t clock : {V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC, V4L2_BUF_FLAG_TIMESTAMP_COPY, V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN}) {
    SCOPED_TRACE(clock);
    FakeLinux linux_;
    V4l2Camera camera(small(), linux_);
    ASSERT_EQ(camera.open(), port_ok);
    const std::int64_t stamp = linux_.monotonic - 5'000'000;
    Image image;
    linux_.frames.push_back({.sequence = 0, .stamp_ns = stamp, .flags = clock});
    ASSERT_EQ(camera.receive(image), port_ok);
    linux_.frames.push_back({.sequence = 1, .stamp_ns = stamp, .flags = clock});
    EXPECT_EQ(camera.receive(image), port_empty);
    linux_.pass(2'000'000'000);  // a stamp of an open kind is too old by now to be believed; it still tells that the image is the same
    linux_.frames.push_back({.sequence = 2, .stamp_ns = stamp, .flags = clock});
    EXPECT_EQ(camera.receive(image), port_empty);
    linux_.frames.push_back({.sequence = 3, .stamp_ns = linux_.monotonic - 1'000'000, .flags = clock});
    EXPECT_EQ(camera.receive(image), port_ok);
    EXPECT_EQ(camera.stats().repeated, 2u);
    EXPECT_EQ(camera.stats().images, 2u);
    EXPECT_EQ(camera.stats().skipped, 0u);
    EXPECT_EQ(camera.stats().broken, 0u);
    EXPECT_EQ(camera.stats().stamps_missed, 0u);
  }
}

// Stamps that cannot be believed, of a driver without a clock, tell nothing about repeats.
TEST(V4l2Camera, ImagesWithoutATimeStampAreNoRepeats) {
  for (const std::int64_t stamp : {std::int64_t{0}, std::int64_t{1'700'000'000'000'000'000}}) {
    FakeLinux linux_;
    V4l2Camera camera(small(), linux_);
    ASSERT_EQ(camera.open(), port_ok);
    for (std::uint32_t n = 0; n < 3; ++n) {
      linux_.frames.push_back({.sequence = n, .stamp_ns = stamp, .flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN});
      Image image;
      EXPECT_EQ(camera.receive(image), port_ok);
    }
    EXPECT_EQ(camera.stats().repeated, 0u);
    EXPECT_EQ(camera.stats().stamps_missed, 3u);
  }
}

TEST(V4l2Camera, EveryBufferComesBackToTheDriver) {
  FakeLinux linux_;
  V4l2Camera camera(small(), linux_);
  ASSERT_EQ(camera.open(), port_ok);
  for (std::uint32_t n = 0; n < 50; ++n) {
    linux_.frames.push_back({.sequence = n, .stamp_ns = n + 1});
    Image image;
    ASSERT_EQ(camera.receive(image), port_ok);
    EXPECT_EQ(linux_.queued.size(), 3u);  // one is lent
  }
}

TEST(V4l2Camera, ACameraThatGoesAwayIsFoundAgain) {
  FakeLinux linux_;
  V4l2Camera camera(small(), linux_);
  ASSERT_EQ(camera.open(), port_ok);
  Image image;
  linux_.frames.push_back({.sequence = 0, .stamp_ns = 1});
  ASSERT_EQ(camera.receive(image), port_ok);
  linux_.camera_there = false;
  EXPECT_EQ(camera.receive(image), ENODEV);
  EXPECT_EQ(camera.receive(image), ENODEV);
  EXPECT_EQ(camera.stats().losses, 1u);
  linux_.camera_there = true;
  EXPECT_EQ(camera.receive(image), ENODEV);  // not looked for at every call
  linux_.pass(600'000'000);
  linux_.frames.push_back({.sequence = 0, .stamp_ns = 2});
  EXPECT_EQ(camera.receive(image), port_ok);
  EXPECT_EQ(image.sequence, 2u);  // goes on
  EXPECT_EQ(camera.stats().reopened, 1u);
}

// A failed call read as success, and YUYV as grey.
TEST(V4l2Camera, AnyCallThatFailsIsAnError) {
  for (const unsigned long request : {static_cast<unsigned long>(VIDIOC_S_FMT), static_cast<unsigned long>(VIDIOC_QUERYCAP),
                                      static_cast<unsigned long>(VIDIOC_REQBUFS), static_cast<unsigned long>(VIDIOC_QUERYBUF),
                                      static_cast<unsigned long>(VIDIOC_QBUF), static_cast<unsigned long>(VIDIOC_STREAMON)}) {
    for (const int error : {EIO, EINVAL, EBUSY, ENOMEM}) {
      FakeLinux linux_;
      linux_.failing_ioctls[request] = error;
      V4l2Camera camera(small(), linux_);
      EXPECT_NE(camera.open(), port_ok) << request << ", " << error;
      EXPECT_FALSE(camera.is_open());
      EXPECT_FALSE(linux_.streaming);
    }
  }
}

TEST(V4l2Camera, AnImageBearsTheExposureThatTheCameraHas) {
  Image image;
  const auto exposure_with = [&](unsigned long refused, bool says) {
    FakeLinux linux_;
    if (refused != 0) linux_.failing_ioctls[refused] = EINVAL;
    if (!says) linux_.failing_ioctls[VIDIOC_G_CTRL] = EINVAL;
    V4l2Camera camera(small(), linux_);
    EXPECT_EQ(camera.open(), port_ok);
    linux_.frames.push_back({.sequence = 0, .stamp_ns = 1});
    EXPECT_EQ(camera.receive(image), port_ok);
    return image.exposure;
  };
  EXPECT_EQ(exposure_with(0, true), small().exposure);
  EXPECT_EQ(exposure_with(0, false), small().exposure);
  EXPECT_EQ(exposure_with(VIDIOC_S_CTRL, false), Duration{});
}

TEST(V4l2Camera, ACameraThatIsNotThereAtFirstIsFound) {
  FakeLinux linux_;
  linux_.camera_there = false;
  V4l2Camera camera(small(), linux_);
  EXPECT_EQ(camera.open(), ENOENT);
  linux_.camera_there = true;
  linux_.pass(600'000'000);
  linux_.frames.push_back({.sequence = 0, .stamp_ns = 1});
  Image image;
  EXPECT_EQ(camera.receive(image), port_ok);
}

TEST(V4l2Camera, SaysWhatItLacks) {
  FakeLinux linux_;
  linux_.camera_there = false;
  V4l2Camera none(small(), linux_);
  EXPECT_EQ(none.open(), ENOENT);
  linux_.camera_there = true;
  linux_.camera_format = V4L2_PIX_FMT_MJPEG;
  V4l2Camera colour(small(), linux_);
  EXPECT_EQ(colour.open(), EINVAL);
  EXPECT_NE(V4l2Camera::explain(EINVAL, small()).find("8x4"), std::string::npos);
}

}  // namespace
}  // namespace lf::hal
