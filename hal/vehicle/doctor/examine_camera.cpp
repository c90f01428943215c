// The camera: the device, its formats at the configured size, and whether its controls take the configured exposure and gain.
#include <fcntl.h>
#include <linux/videodev2.h>

#include <cerrno>
#include <cstring>
#include <optional>

#include "hal/vehicle/doctor/examination.hpp"

namespace lf::hal::doctor {

namespace {

constexpr std::uint32_t most_entries = 64;  // of any list of a driver's

std::string fourcc(std::uint32_t format) {
  std::string text(4, ' ');
  std::memcpy(text.data(), &format, 4);
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

std::string list(const std::string& text, const std::string& one) { return text.empty() ? one : text + ", " + one; }

class Camera {
 public:
  Camera(const std::string& device, LinuxCalls& calls) : calls_(calls), fd_(calls.open(device.c_str(), O_RDWR | O_NONBLOCK)) {}
  ~Camera() {
    if (fd_ >= 0) calls_.close(fd_);
  }
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  bool is_open() const { return fd_ >= 0; }

  // "uvcvideo, Some Camera"
  std::string name() {
    v4l2_capability capability{};
    if (calls_.ioctl(fd_, VIDIOC_QUERYCAP, &capability) < 0) return "";
    const auto text = [](const __u8* from, std::size_t most) {
      const char* letters = reinterpret_cast<const char*>(from);
      return std::string(letters, strnlen(letters, most));
    };
    const std::string card = text(capability.card, sizeof capability.card), driver = text(capability.driver, sizeof capability.driver);
    return card.empty() ? driver : card + (driver.empty() ? "" : " (" + driver + ")");
  }

  // "GREY 640x480 752x480, YUYV 640x480": all it has, to choose from.
  std::string formats() {
    std::string text;
    for (std::uint32_t i = 0; i < most_entries; ++i) {
      v4l2_fmtdesc format{};
      format.index = i;
      format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      if (calls_.ioctl(fd_, VIDIOC_ENUM_FMT, &format) < 0) break;
      text = list(text, fourcc(format.pixelformat) + sizes(format.pixelformat));
    }
    return text;
  }

  std::optional<v4l2_queryctrl> control(std::uint32_t id) {
    v4l2_queryctrl control{};
    control.id = id;
    if (calls_.ioctl(fd_, VIDIOC_QUERYCTRL, &control) < 0 || (control.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return std::nullopt;
    return control;
  }

 private:
  std::string sizes(std::uint32_t format) {
    std::string text;
    for (std::uint32_t i = 0; i < most_entries; ++i) {
      v4l2_frmsizeenum size{};
      size.index = i;
      size.pixel_format = format;
      if (calls_.ioctl(fd_, VIDIOC_ENUM_FRAMESIZES, &size) < 0) break;
      if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE) {
        const auto by = [](std::uint32_t a, std::uint32_t b) { return std::to_string(a) + "x" + std::to_string(b); };
        return " " + by(size.stepwise.min_width, size.stepwise.min_height) + " to " + by(size.stepwise.max_width, size.stepwise.max_height);
      }
      text += " " + std::to_string(size.discrete.width) + "x" + std::to_string(size.discrete.height);
    }
    return text;
  }

  LinuxCalls& calls_;
  int fd_;
};

void examine_exposure(const VehicleConfig& config, Camera& camera, Examinations& found) {
  constexpr const char* key = "camera.exposure_us";
  const std::int64_t wanted_us = config.v4l2().exposure.ns() / 1000;
  const auto exposure = camera.control(V4L2_CID_EXPOSURE_ABSOLUTE);
  if (!camera.control(V4L2_CID_EXPOSURE_AUTO) || !exposure) {
    found.push_back({"exposure", key, Grade::note, "the camera has no exposure by hand: images bear the exposure that it has, or none",
                     "a camera whose exposure can be set, or its own trigger mode"});
    return;
  }
  // V4L2 counts in 100 us.
  const std::int64_t least_us = 100LL * exposure->minimum, most_us = 100LL * exposure->maximum;
  const std::string range = std::to_string(least_us) + " to " + std::to_string(most_us) + " us";
  const bool good = wanted_us >= least_us && wanted_us <= most_us;
  found.push_back({"exposure", key, good ? Grade::good : Grade::bad,
                   std::to_string(wanted_us) + " us" + (good ? ", of " : " is out of what it takes: ") + range,
                   good ? "" : "`camera.exposure_us` within that"});
  if (good && wanted_us % 100 != 0)
    found.push_back(
        {"exposure's step", key, Grade::note,
         std::to_string(wanted_us) + " us is rounded up to " + std::to_string((wanted_us + 99) / 100 * 100) + " us: V4L2 counts in 100 us",
         "`camera.exposure_us: " + std::to_string((wanted_us + 99) / 100 * 100) + "`"});
}

void examine_gain(const VehicleConfig& config, Camera& camera, Examinations& found) {
  const auto gain = camera.control(V4L2_CID_GAIN);
  if (!gain) {
    found.push_back({"gain", "camera.gain", Grade::note, "the camera has no gain that can be set", "none, where its gain is fixed"});
    return;
  }
  const bool good = config.gain >= gain->minimum && config.gain <= gain->maximum;
  found.push_back({"gain", "camera.gain", good ? Grade::good : Grade::bad,
                   std::to_string(config.gain) + (good ? ", of " : " is out of what it takes: ") + std::to_string(gain->minimum) + " to " +
                       std::to_string(gain->maximum),
                   good ? "" : "`camera.gain` within that"});
}

void examine_device(const VehicleConfig& config, const Machine& machine, Examinations& found) {
  constexpr const char* key = "camera.device";
  const V4l2Camera::Config wanted = config.v4l2();
  std::string name, formats;
  {
    Camera camera(wanted.device, *machine.calls);
    if (camera.is_open()) {
      name = camera.name();
      formats = camera.formats();
      examine_exposure(config, camera, found);
      examine_gain(config, camera, found);
    }
  }
  V4l2Camera camera(wanted, *machine.calls);
  const PortStatus error = camera.open();
  const std::string size = std::to_string(wanted.width) + "x" + std::to_string(wanted.height);
  const std::string all = formats.empty() ? "" : "; it has " + formats;
  if (error == port_ok) {
    found.push_back(
        {"camera", key, Grade::good, wanted.device + ": " + (name.empty() ? "" : name + ", ") + size + " as " + camera.format(), ""});
  } else if (error == EBUSY && machine.daemon_runs) {
    found.push_back({"camera", key, Grade::good, wanted.device + ": the daemon has it" + all, ""});
  } else {
    const std::string remedy =
        error == EINVAL ? "a camera, or a mode of it, with such an image" : "connect it and free it, or name another (`camera.device`)";
    found.push_back({"camera", key, Grade::bad, V4l2Camera::explain(error, wanted) + (error == EINVAL ? all : ""),
                     remedy + "; without it `start` is refused"});
  }
}

}  // namespace

void examine_camera(const VehicleConfig& config, const Machine& machine, Examinations& found) {
  if (config.camera_source == "none")
    found.push_back({"camera", "camera.source", Grade::note, "none is configured: `start` is refused, `home`, `jog` and stowing need none",
                     "`camera.source: device`"});
  if (config.camera_source == "device") examine_device(config, machine, found);
  if (config.camera_source != "ring") return;
  const int fd = machine.calls->open(config.ring.c_str(), O_RDONLY);
  if (fd >= 0) {
    machine.calls->close(fd);
    found.push_back({"camera", "camera.ring", Grade::good, config.ring + " is there", ""});
  } else {
    found.push_back({"camera", "camera.ring", Grade::bad, config.ring + ": " + std::strerror(-fd),
                     "start what writes it, such as `lanternfish serve`"});
  }
}

}  // namespace lf::hal::doctor
