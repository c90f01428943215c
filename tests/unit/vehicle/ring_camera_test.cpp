#include "hal/vehicle/ring_camera.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <thread>
#include <vector>

#include "hal/vehicle/tick_clock.hpp"
#include "shared/frame_ring/mapped_file.hpp"
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

TEST_F(Ring, ARingCutShortIsASilentCameraUntilItIsThereAgain) {
  RingCamera camera(config);
  ASSERT_EQ(camera.open(), port_ok);
  std::uint32_t sequence = 0;
  for (const std::size_t left : {std::size_t{0}, std::size_t{1}, frame_ring_page, config.bytes / 2}) {
    ASSERT_TRUE(writer.open(file.bytes()));
    (void)camera.receive(image);
    // The last of the four slots, which each cut loses.
    for (std::uint32_t slot = 0; slot < camera_ring_slots; ++slot) {
      ASSERT_TRUE(writer.write(frame_info(sequence++, 1), pixels, 1));
      if (slot + 1 < camera_ring_slots) {
        ASSERT_EQ(camera.receive(image), port_ok);
      }
    }
    std::filesystem::resize_file(config.path, left);
    EXPECT_EQ(camera.receive(image), port_empty) << left << " bytes left";
    camera.wait(monotonic_now() + Duration::from_ms(3));
    EXPECT_EQ(camera.receive(image), port_empty) << left << " bytes left";
    std::filesystem::resize_file(config.path, config.bytes);
    ASSERT_TRUE(writer.open(file.bytes()));
    (void)camera.receive(image);
    ASSERT_TRUE(writer.write(frame_info(sequence++, 7), pixels, 1));
    ASSERT_EQ(camera.receive(image), port_ok) << "after " << left << " bytes";
    EXPECT_EQ(image.trigger, 7);
    EXPECT_EQ(image.view.at(639, 479), 9);
  }
}

TEST_F(Ring, ARingCutShortWhileItIsReadEndsNothing) {
  RingCamera camera(config);
  ASSERT_EQ(camera.open(), port_ok);
  ASSERT_TRUE(writer.open(file.bytes()));
  std::atomic<bool> over = false;
  std::thread cutting([&] {
    for (std::uint32_t n = 0; n < 200; ++n) {
      // The writer, which maps the file, writes only while all of it is there.
      (void)writer.open(file.bytes());
      for (std::uint32_t i = 0; i < camera_ring_slots; ++i) (void)writer.write(frame_info(n, 1), pixels, 1);
      std::filesystem::resize_file(config.path, n % 2 == 0 ? 0 : config.bytes / 2);
      std::filesystem::resize_file(config.path, config.bytes);
    }
    over = true;
  });
  int looks = 0;
  for (; !over; ++looks) {
    const PortStatus status = camera.receive(image);
    EXPECT_TRUE(status == port_ok || status == port_empty || status == EPROTO) << status;
  }
  cutting.join();
  EXPECT_GT(looks, 0);
}

// The camera keeps the file that it opened, as the writer does.
TEST_F(Ring, AFileDeletedOrReplacedIsTheOneThatWasOpened) {
  RingCamera camera(config);
  ASSERT_EQ(camera.open(), port_ok);
  ASSERT_TRUE(writer.open(file.bytes()));
  (void)camera.receive(image);
  std::filesystem::remove(config.path);
  ASSERT_TRUE(writer.write(frame_info(0, 17), pixels, 1));
  ASSERT_EQ(camera.receive(image), port_ok);
  EXPECT_EQ(image.trigger, 17);
  MappedFile other;
  ASSERT_EQ(other.open(config.path, config.bytes), 0);
  FrameRingWriter stranger;
  ASSERT_TRUE(stranger.open(other.bytes()));
  ASSERT_TRUE(stranger.write(frame_info(1, 99), pixels, 1));
  EXPECT_EQ(camera.receive(image), port_empty);
  ASSERT_TRUE(writer.write(frame_info(1, 18), pixels, 1));
  ASSERT_EQ(camera.receive(image), port_ok);
  EXPECT_EQ(image.trigger, 18);
}

TEST_F(Ring, WhatCannotBeReadAtAPlaceIsRefused) {
  config.path = folder / "pipe";
  ASSERT_EQ(mkfifo(config.path.c_str(), 0600), 0);
  EXPECT_EQ(RingCamera(config).open(), ESPIPE);
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
