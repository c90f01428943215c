#include "hal/vehicle/ring_camera.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <vector>

#include "hal/vehicle/tick_clock.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::hal {
namespace {

RecordInfo frame_info(std::uint32_t sequence, std::int32_t trigger) {
  RecordInfo info;
  info.width = 640;
  info.height = 480;
  info.stride = 640;
  info.start_ns = 5'000'000;
  info.exposure_ns = 2'000'000;
  info.sequence = sequence;
  info.trigger = trigger;
  return info;
}

class Ring : public testing::Test {
 protected:
  Ring() {
    config.path = folder / "ring";
    EXPECT_EQ(file.open(config.path, config.bytes), 0);
  }
  test::TemporaryFolder folder;
  RingCamera::Config config;
  MappedFile file;
  FrameRingWriter writer;
  std::vector<std::byte> pixels = std::vector<std::byte>(camera_ring_payload, std::byte{9});
  Image image;
};

TEST_F(Ring, FramesComeWithTheirTrigger) {
  RingCamera camera(config);
  ASSERT_EQ(camera.open(), port_ok);
  EXPECT_EQ(camera.receive(image), port_empty);  // nobody has laid it out
  ASSERT_TRUE(writer.open(file.bytes()));
  EXPECT_EQ(camera.receive(image), port_empty);
  ASSERT_TRUE(writer.write(frame_info(0, 17), pixels, 1));
  camera.wait(monotonic_now() + Duration::from_s(1));
  ASSERT_EQ(camera.receive(image), port_ok);
  EXPECT_EQ(image.trigger, 17);
  EXPECT_EQ(image.exposure_start.ns(), 5'000'000);
  EXPECT_EQ(image.exposure.ns(), 2'000'000);
  EXPECT_EQ(image.view.at(639, 479), 9);
  EXPECT_EQ(camera.receive(image), port_empty);
}

TEST_F(Ring, CountsGapsAndWhatIsNoImage) {
  RingCamera camera(config);
  ASSERT_EQ(camera.open(), port_ok);
  ASSERT_TRUE(writer.open(file.bytes()));
  (void)camera.receive(image);
  ASSERT_TRUE(writer.write(frame_info(0, 1), pixels, 1));
  ASSERT_EQ(camera.receive(image), port_ok);
  ASSERT_TRUE(writer.write(frame_info(4, 2), pixels, 1));
  ASSERT_EQ(camera.receive(image), port_ok);
  EXPECT_EQ(camera.skipped(), 3u);
  RecordInfo wrong = frame_info(5, 3);
  wrong.height = 100'000;
  ASSERT_TRUE(writer.write(wrong, pixels, 1));
  EXPECT_EQ(camera.receive(image), port_empty);
  EXPECT_EQ(camera.broken(), 1u);
}

TEST_F(Ring, AnotherLayoutIsAnErrorAndAMissingFolderToo) {
  RingCamera camera(config);
  ASSERT_EQ(camera.open(), port_ok);
  ASSERT_TRUE(writer.open(file.bytes()));
  reinterpret_cast<RingHeader*>(file.bytes().data())->version.store(99);
  EXPECT_EQ(camera.receive(image), EPROTO);
  config.path = folder / "no/ring";
  EXPECT_EQ(RingCamera(config).open(), ENOENT);
}

TEST_F(Ring, WaitsNoLongerThanItIsTold) {
  RingCamera camera(config);
  ASSERT_EQ(camera.open(), port_ok);
  const Time before = monotonic_now();
  camera.wait(before + Duration::from_ms(20));
  EXPECT_GE((monotonic_now() - before).ns(), 20'000'000);
}

}  // namespace
}  // namespace lf::hal
