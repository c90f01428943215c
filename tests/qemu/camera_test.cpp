// V4l2Camera on the kernel's own V4L2: a loopback device that this test writes at 20 Hz, and vivid, a camera that can be told to drop, to spoil and to go
// away. Run as root of the guest of run_in_qemu.sh.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "hal/vehicle/v4l2_camera.hpp"

namespace lf::hal {
namespace {

constexpr int width = 640, height = 480;

Time now() { return Time::from_ns(linux_calls().monotonic_ns()); }
bool shell(const std::string& command) { return std::system(command.c_str()) == 0; }

bool in_guest() {
  const char* guest = std::getenv("LANTERNFISH_GUEST");
  return guest != nullptr && std::string(guest) == "qemu";
}

// What a camera that is watched for `span` hands over.
struct Taken {
  Image image;  // its pixels are gone
  std::uint8_t first = 0, last = 0;
  Time at;
};
std::vector<Taken> watch(V4l2Camera& camera, Duration span, std::vector<PortStatus>* errors = nullptr) {
  std::vector<Taken> all;
  for (const Time until = now() + span; now() < until;) {
    camera.wait(now() + Duration::from_ms(10));
    Image image;
    const PortStatus status = camera.receive(image);
    if (status == port_ok) {
      all.push_back({image, image.view.at(0, 0), image.view.at(width - 1, height - 1), now()});
    } else if (status != port_empty && errors != nullptr) {
      errors->push_back(status);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  return all;
}

// Writes grey frames into a loopback device, each full of its own number.
class Loopback {
 public:
  explicit Loopback(const char* device) : fd_(::open(device, O_RDWR)) {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    format.fmt.pix.width = width;
    format.fmt.pix.height = height;
    format.fmt.pix.pixelformat = V4L2_PIX_FMT_GREY;
    format.fmt.pix.sizeimage = width * height;
    format.fmt.pix.bytesperline = width;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    ready_ = fd_ >= 0 && ::ioctl(fd_, VIDIOC_S_FMT, &format) == 0;
  }
  ~Loopback() { ::close(fd_); }
  Loopback(const Loopback&) = delete;
  Loopback& operator=(const Loopback&) = delete;

  bool ready() const { return ready_; }
  void write(std::uint8_t number) {
    frame_.assign(static_cast<std::size_t>(width) * height, number);
    ready_ = ::write(fd_, frame_.data(), frame_.size()) == static_cast<ssize_t>(frame_.size()) && ready_;
  }

 private:
  int fd_;
  bool ready_ = false;
  std::vector<std::uint8_t> frame_;
};

class CameraTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!in_guest()) GTEST_SKIP() << "no V4L2 here: run it through ctest -L qemu";
  }

  static V4l2Camera::Config config(const std::string& device) {
    V4l2Camera::Config c;
    c.device = device;
    c.width = width;
    c.height = height;
    return c;
  }
};

TEST_F(CameraTest, TakesTwentyFramesASecondWholeInOrderAndWithTheirTimes) {
  Loopback writer("/dev/video0");
  ASSERT_TRUE(writer.ready());
  writer.write(0);  // a loopback device is a camera once it has a picture
  V4l2Camera camera(config("/dev/video0"));
  ASSERT_EQ(camera.open(), port_ok);
  ASSERT_STREQ(camera.format(), "GREY");
  (void)watch(camera, Duration::from_ms(100));

  constexpr int count = 60;
  const std::chrono::milliseconds period(50);
  std::vector<Time> written(count);
  std::atomic<bool> sound{true};
  std::thread camera_side([&] {
    auto due = std::chrono::steady_clock::now();
    for (int i = 0; i < count; ++i) {
      std::this_thread::sleep_until(due += period);
      written[i] = now();
      writer.write(static_cast<std::uint8_t>(i + 1));
    }
    sound = writer.ready();
  });
  const std::vector<Taken> taken = watch(camera, Duration::from_ms(count * 50 + 200));
  camera_side.join();

  ASSERT_TRUE(sound);
  ASSERT_EQ(taken.size(), static_cast<std::size_t>(count));
  Duration latest;
  for (int i = 0; i < count; ++i) {
    EXPECT_EQ(taken[i].first, i + 1);
    EXPECT_EQ(taken[i].last, i + 1);
    EXPECT_EQ(taken[i].image.sequence, taken[0].image.sequence + static_cast<unsigned>(i));
    EXPECT_GE(taken[i].image.exposure_start, written[i] - Duration::from_us(1)) << i;  // stamps are whole microseconds
    EXPECT_LE(taken[i].image.exposure_start, written[i] + Duration::from_ms(2)) << i;
    latest = std::max(latest, taken[i].at - written[i]);
  }
  EXPECT_LE(latest, Duration::from_ms(5)) << "from the writer's hand into ours";
  EXPECT_EQ(camera.stats().skipped + camera.stats().broken + camera.stats().repeated + camera.stats().stamps_missed, 0u);
  std::printf("20 Hz, %d frames: none lost, in hand at most %.2f ms after it was written\n", count, 1e3 * latest.s());
}

TEST_F(CameraTest, AWriterThatPausesIsNoErrorAndGoesOn) {
  Loopback writer("/dev/video1");
  ASSERT_TRUE(writer.ready());
  writer.write(1);
  V4l2Camera camera(config("/dev/video1"));
  ASSERT_EQ(camera.open(), port_ok);
  (void)watch(camera, Duration::from_ms(100));
  std::vector<PortStatus> errors;
  EXPECT_TRUE(watch(camera, Duration::from_ms(500), &errors).empty());
  EXPECT_TRUE(errors.empty());
  writer.write(2);
  const std::vector<Taken> taken = watch(camera, Duration::from_ms(100), &errors);
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_EQ(taken[0].first, 2);
}

// vivid as /dev/videoN; 25 frames a second.
class FailingCameraTest : public CameraTest {
 protected:
  void SetUp() override {
    CameraTest::SetUp();
    if (IsSkipped()) return;
    ASSERT_TRUE(plug_in());
  }
  void TearDown() override {
    if (in_guest()) (void)shell("rmmod vivid");
  }

  bool plug_in() {
    if (!shell("insmod /run/modules/vivid.ko n_devs=1 node_types=0x1 num_inputs=1 input_types=0")) return false;
    for (const auto& entry : std::filesystem::directory_iterator("/sys/class/video4linux")) {
      std::string name;
      std::getline(std::ifstream(entry.path() / "name"), name);
      if (name.find("vid-cap") != std::string::npos) device_ = "/dev/" + entry.path().filename().string();
    }
    return !device_.empty() &&
           shell("v4l2-ctl -d " + device_ + " --set-fmt-video=width=640,height=480,pixelformat=GREY --set-parm=25 >/tmp/log");
  }
  bool inject(const std::string& control) { return shell("v4l2-ctl -d " + device_ + " --set-ctrl=" + control); }

  std::string device_;
};

TEST_F(FailingCameraTest, CountsDroppedFramesAsGapsAndSpoiltOnesAsBroken) {
  V4l2Camera camera(config(device_));
  ASSERT_EQ(camera.open(), port_ok);
  ASSERT_FALSE(watch(camera, Duration::from_ms(400)).empty());
  ASSERT_EQ(camera.stats().skipped, 0u);
  ASSERT_TRUE(inject("percentage_of_dropped_buffers=40"));
  const std::vector<Taken> taken = watch(camera, Duration::from_ms(2000));
  ASSERT_TRUE(inject("percentage_of_dropped_buffers=0"));
  ASSERT_GT(taken.size(), 10u);
  EXPECT_GT(camera.stats().skipped, 5u);
  EXPECT_EQ(taken.back().image.sequence - taken.front().image.sequence + 1, taken.size() + camera.stats().skipped);

  const std::uint64_t broken = camera.stats().broken;
  ASSERT_TRUE(inject("inject_v4l2_buf_flag_error=1"));
  ASSERT_FALSE(watch(camera, Duration::from_ms(300)).empty());
  EXPECT_EQ(camera.stats().broken, broken + 1);
}

TEST_F(FailingCameraTest, OneThatFailsForGoodIsSetUpAnew) {
  V4l2Camera camera(config(device_));
  ASSERT_EQ(camera.open(), port_ok);
  ASSERT_FALSE(watch(camera, Duration::from_ms(300)).empty());
  ASSERT_TRUE(inject("inject_fatal_streaming_error=1"));
  std::vector<PortStatus> errors;
  const std::vector<Taken> taken = watch(camera, Duration::from_ms(2000), &errors);
  ASSERT_FALSE(errors.empty());
  EXPECT_EQ(errors.front(), ENODEV);
  EXPECT_GT(taken.size(), 10u);
  EXPECT_EQ(camera.stats().losses, 1u);
  EXPECT_EQ(camera.stats().reopened, 1u);
}

TEST_F(FailingCameraTest, OneThatIsUnpluggedIsTakenUpAgainWhenItIsBack) {
  V4l2Camera camera(config(device_));
  ASSERT_EQ(camera.open(), port_ok);
  ASSERT_FALSE(watch(camera, Duration::from_ms(300)).empty());
  Time last = now();
  ASSERT_TRUE(inject("disconnect=1"));  // vivid is plugged in again when its last user has closed it
  std::vector<PortStatus> errors;
  const std::vector<Taken> taken = watch(camera, Duration::from_ms(2000), &errors);
  ASSERT_FALSE(errors.empty());
  EXPECT_EQ(errors.front(), ENODEV);
  EXPECT_GT(taken.size(), 10u);
  Duration gap;
  for (const Taken& one : taken) {
    gap = std::max(gap, one.at - last);
    last = one.at;
  }
  EXPECT_GE(gap, Duration::from_ms(400)) << "it was gone";
  EXPECT_EQ(camera.stats().losses, 1u);
  EXPECT_EQ(camera.stats().reopened, 1u);
}

TEST_F(CameraTest, WhatIsNoCameraIsRefused) {
  EXPECT_EQ(V4l2Camera(config("/dev/video77")).open(), ENOENT);
  EXPECT_EQ(V4l2Camera(config("/dev/null")).open(), EINVAL);
}

}  // namespace
}  // namespace lf::hal
