// The doctor's look at the camera: formats and size, exposure and gain against the configuration, and who else has it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "hal/vehicle/doctor/examination.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "tests/unit/vehicle/fake_linux.hpp"

namespace lf::hal::doctor {
namespace {

using testing::HasSubstr;

class CameraExamination : public testing::Test {
 protected:
  CameraExamination() : config(configured("")) {}

  static VehicleConfig configured(const std::string& camera) {
    const test::TemporaryFolder folder;
    return load_vehicle_config(folder.write("v.yaml", "camera: {" + camera + "}\n"));
  }
  Examination look(const std::string& subject) {
    Machine machine;
    machine.calls = &kernel;
    machine.daemon_runs = daemon_runs;
    Examinations found;
    examine_camera(config, machine, found);
    EXPECT_FALSE(kernel.streaming) << "the camera was left at work";
    for (const Examination& one : found) {
      if (one.subject == subject) return one;
    }
    return {subject, "", Grade::good, "nothing", ""};
  }

  test::FakeLinux kernel;
  VehicleConfig config;
  bool daemon_runs = false;
};

TEST_F(CameraExamination, ACameraAsConfiguredIsGood) {
  EXPECT_EQ(look("camera").grade, Grade::good);
  EXPECT_EQ(look("camera").found, "/dev/video0: 640x480 as GREY");
  EXPECT_EQ(look("exposure").found, "2000 us, of 100 to 500000 us");
  EXPECT_EQ(look("gain").found, "0, of 0 to 100");
}

TEST_F(CameraExamination, OneWithoutASuitableImageSaysWhichItHas) {
  kernel.formats = {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_NV12};
  kernel.failing_ioctls[VIDIOC_S_FMT] = EINVAL;
  const Examination camera = look("camera");
  EXPECT_EQ(camera.grade, Grade::bad);
  EXPECT_THAT(camera.found, HasSubstr("has no 640x480 image in GREY, Y10, Y16 or YUYV"));
  EXPECT_THAT(camera.found, HasSubstr("it has MJPG 640x480, NV12 640x480"));
  EXPECT_THAT(camera.remedy, HasSubstr("`start` is refused"));
}

TEST_F(CameraExamination, ExposureAndGainOutOfTheCamerasRangesAreBad) {
  kernel.exposure_range = {1, 10};
  kernel.gain_range = {16, 64};
  EXPECT_EQ(look("exposure").grade, Grade::bad);
  EXPECT_THAT(look("exposure").found, HasSubstr("2000 us is out of what it takes: 100 to 1000 us"));
  EXPECT_EQ(look("gain").grade, Grade::bad);
  EXPECT_THAT(look("gain").found, HasSubstr("0 is out of what it takes: 16 to 64"));
}

TEST_F(CameraExamination, ACameraWithoutControlsWorksAndIsNoted) {
  kernel.exposure_range = kernel.gain_range = {1, 0};
  EXPECT_EQ(look("camera").grade, Grade::good);
  EXPECT_EQ(look("exposure").grade, Grade::note);
  EXPECT_EQ(look("gain").grade, Grade::note);
}

TEST_F(CameraExamination, AnExposureBetweenTheUnitsOfV4l2IsNoted) {
  config = configured("exposure_us: 2050");
  EXPECT_THAT(look("exposure's step").found, HasSubstr("rounded up to 2100 us"));
  config = configured("exposure_us: 2100");
  EXPECT_EQ(look("exposure's step").found, "nothing");
}

TEST_F(CameraExamination, WhoElseHasTheCameraDecides) {
  kernel.failing_ioctls[VIDIOC_S_FMT] = EBUSY;
  EXPECT_EQ(look("camera").grade, Grade::bad);
  EXPECT_THAT(look("camera").found, HasSubstr("another program has it"));
  daemon_runs = true;
  EXPECT_EQ(look("camera").grade, Grade::good);
  EXPECT_THAT(look("camera").found, HasSubstr("the daemon has it"));
}

TEST_F(CameraExamination, NoDeviceAndNoCameraAtAll) {
  kernel.camera_there = false;
  EXPECT_THAT(look("camera").found, HasSubstr("/dev/video0: there is no camera"));
  config = configured("source: none");
  EXPECT_EQ(look("camera").grade, Grade::note);
  config = configured("source: ring, ring: /dev/shm/no-such-ring");
  EXPECT_EQ(look("camera").grade, Grade::bad);
  EXPECT_THAT(look("camera").found, HasSubstr("/dev/shm/no-such-ring: No such file"));
}

// A driver that never ends a list must not hold the doctor.
TEST_F(CameraExamination, AListThatNeverEndsIsCutShort) {
  kernel.formats.assign(100'000, V4L2_PIX_FMT_MJPEG);
  EXPECT_EQ(look("camera").grade, Grade::good);
}

}  // namespace
}  // namespace lf::hal::doctor
