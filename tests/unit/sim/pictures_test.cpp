// Pictures through the simulated platform: the test is the core, by CAN frames alone, and looks at what comes back.
#include <gtest/gtest.h>

#include <initializer_list>
#include <optional>

#include "hal/sim/sim_platform.hpp"
#include "host_sim/scenario/instance.hpp"
#include "tests/arm5e_bodies.hpp"

namespace lf::hal {
namespace {

constexpr std::uint8_t laser = can_map::output_laser, lamps = can_map::output_lamps;

// An even picture but for what is ordered: the camera's frames do not differ by themselves.
SimConfig config_of(const std::vector<std::string>& set = {}) {
  const scenario::Scenario scenario = scenario::load_scenario("default", set);
  const scenario::Sample sample = scenario::draw(scenario, 3);
  SimConfig config = scenario::make_truth(scenario, sample, scenario::make_nominal(scenario, true), 1);
  config.optics.cameras[0].exposure_jitter = config.optics.cameras[0].row_noise_grey = 0;
  config.optics.cameras[0].ghost_share = 0;
  config.optics.lasers[0].speckle = 0;
  config.optics.water.particles_per_l = 0;
  // The laser stands with the vehicle here, before the panel, wherever the arm is stowed.
  config.optics.lasers[0].body = arm5e_body::vehicle;
  config.optics.lasers[0].body_from_laser.linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;  // a level sheet
  config.optics.lasers[0].body_from_laser.translation() = Vec3(0.05, 0, 0.5);
  config.exposure_delay = Duration();
  config.stamp_offset = Duration();
  return config;
}

struct Taken {
  Image image;
  Time received;
  double grey = 0;   // mean
  double above = 0;  // mean of what the brightest row of each column is over it: the laser's line
};

class CoreInTheTest {
 public:
  explicit CoreInTheTest(const SimConfig& config) : platform_(config, observer_) {
    for (int i = 0; i < 500 && !booted_; ++i) tick();
    EXPECT_TRUE(booted_);
    write(0x1400, 1, 0x80000206u);
    write(0x1400, 2, 1);
    write(0x1600, 0, 0);
    write(0x1600, 1, 0x62000108u);
    write(0x1600, 2, 0x21000108u);
    write(0x1600, 3, 0x21000210u);
    write(0x1600, 0, 3);
    write(0x1400, 1, 0x206);
    send({0x000, {1, 6}});
    tick();
  }

  // At the next SYNC these outputs, and an exposure if there is one.
  void order(std::uint8_t outputs, std::optional<int> exposure_us = std::nullopt) {
    if (exposure_us) ++trigger_, exposure_us_ = *exposure_us;
    send({0x206, {outputs, trigger_, std::uint8_t(exposure_us_ & 0xFF), std::uint8_t(exposure_us_ >> 8)}});
    send({0x080, {}});
    tick();
  }

  std::optional<Taken> look() {
    Taken taken;
    if (platform_.receive_image(0, taken.image) != port_ok) return std::nullopt;
    taken.received = now_;
    const ImageView& view = taken.image.view;
    for (std::int32_t u = 0; u < view.width; ++u) {
      double sum = 0, most = 0;
      for (std::int32_t v = 0; v < view.height; ++v) {
        const double grey = view.data[v * view.stride + u];
        sum += grey, most = std::max(most, grey);
      }
      taken.grey += sum / view.height / view.width;
      taken.above += most / view.width;
    }
    return taken;
  }

  // The next picture, while SYNCs go on with these outputs.
  Taken wait(std::uint8_t outputs) {
    for (int i = 0; i < 50; ++i) {
      if (const std::optional<Taken> taken = look()) return *taken;
      order(outputs);
    }
    ADD_FAILURE() << "no picture";
    return {};
  }
  // An exposure of that length with these outputs throughout.
  Taken picture(std::uint8_t outputs, int exposure_us) {
    order(outputs, exposure_us);
    return wait(outputs);
  }
  Time now() const { return now_; }

 private:
  struct Message {
    std::uint32_t id;
    std::initializer_list<std::uint8_t> bytes;
  };
  void send(const Message& message) {
    CanFrame frame;
    frame.id = message.id;
    frame.length = static_cast<std::uint8_t>(message.bytes.size());
    std::copy(message.bytes.begin(), message.bytes.end(), frame.data.begin());
    ASSERT_EQ(platform_.send_can(0, {&frame, 1}), port_ok);
  }
  // Expedited, as CiA 301 has it; the answer is awaited for one tick.
  void write(std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
    const std::uint8_t command = index == 0x1400 && sub == 2 ? 0x2F : index == 0x1600 && sub == 0 ? 0x2F : 0x23;
    send({0x606,
          {command, std::uint8_t(index & 0xFF), std::uint8_t(index >> 8), sub, std::uint8_t(value & 0xFF), std::uint8_t(value >> 8 & 0xFF),
           std::uint8_t(value >> 16 & 0xFF), std::uint8_t(value >> 24)}});
    tick();
    EXPECT_EQ(answer_, 0x60) << std::hex << index << "." << int(sub);
  }
  void tick() {
    ASSERT_EQ(platform_.wait_for_tick(now_), port_ok);
    ReceivedFrame received;
    while (platform_.receive_can(0, received) == port_ok) {
      booted_ = booted_ || received.frame.id == 0x706;
      if (received.frame.id == 0x586) answer_ = received.frame.data[0];
    }
  }

  SimObserver observer_;
  SimPlatform platform_;
  Time now_;
  std::uint8_t trigger_ = 0, answer_ = 0;
  bool booted_ = false;
  int exposure_us_ = 0;
};

// Of 300,000 pixels the noise's mean is nothing; rounding and the clip at 0 add a few hundredths.
constexpr double least_grey = 0.1;

TEST(Pictures, AnOrderedExposureIsObeyedWhateverTheConfigurationSays) {
  const SimConfig config = config_of();
  ASSERT_EQ(config.optics.cameras[0].exposure, Duration::from_us(2000));
  CoreInTheTest core(config);
  const Taken configured = core.picture(0, 2000), shorter = core.picture(0, 1000), longer = core.picture(0, 3000);
  ASSERT_GT(configured.grey, 20);
  EXPECT_NEAR(shorter.grey, 0.5 * configured.grey, least_grey + 0.005 * configured.grey);
  EXPECT_NEAR(longer.grey, 1.5 * configured.grey, least_grey + 0.005 * configured.grey);
  EXPECT_EQ(shorter.image.exposure, Duration::from_us(1000));
  EXPECT_EQ(longer.image.exposure, Duration::from_us(3000));
}

TEST(Pictures, OutputsLightThePictureThatTheyAreOrderedFor) {
  CoreInTheTest core(config_of());
  const Taken dark = core.picture(0, 1000), lit = core.picture(lamps, 1000), line = core.picture(laser, 1000);
  EXPECT_GT(lit.grey, dark.grey + 3);
  EXPECT_GT(line.above, dark.above + 20);
  EXPECT_LT(line.grey, dark.grey + 2);
}

// Outputs switch at a SYNC, 4 ms after the one that began the exposure: of 6 ms they light four, less what the shutter opens late.
TEST(Pictures, AnOutputThatIsSwitchedMeanwhileLightsItsShare) {
  for (const int delay_us : {0, 500}) {
    SimConfig config = config_of();
    config.optics.cameras[0].sensitivity *= 0.25;  // so that 6 ms do not clip
    config.exposure_delay = Duration::from_us(delay_us);
    CoreInTheTest core(config);
    const Taken dark = core.picture(0, 6000), lit = core.picture(lamps, 6000);
    core.order(lamps, 6000);
    const double off_midway = core.wait(0).grey;
    core.order(0, 6000);
    const double on_midway = core.wait(lamps).grey;
    // The first step of a SYNC's millisecond has the outputs of its end.
    const double share = (4000.0 - delay_us) / 6000, step = 1.0 / 6;
    EXPECT_NEAR((off_midway - dark.grey) / (lit.grey - dark.grey), share, 0.5 * step) << delay_us;
    EXPECT_NEAR((on_midway - dark.grey) / (lit.grey - dark.grey), 1 - share, 0.5 * step) << delay_us;
    EXPECT_NEAR(off_midway - dark.grey + on_midway - dark.grey, lit.grey - dark.grey, 0.02 * lit.grey) << "together the whole";
  }
}

TEST(Pictures, NoPictureIsDeliveredBeforeItIsExposed) {
  SimConfig config = config_of({"latency.image_ms=0"});
  for (const int delay_us : {0, 500}) {
    config.exposure_delay = Duration::from_us(delay_us);
    CoreInTheTest core(config);
    for (const int exposure_us : {1000, 6000, 15000}) {
      core.order(0, exposure_us);
      const Taken taken = core.wait(0);
      const Time closed = taken.image.exposure_start + Duration::from_us(delay_us + exposure_us);
      EXPECT_GE(taken.received, closed) << exposure_us;
      EXPECT_LT(taken.received, closed + can_map::sync_period + Duration::from_ms(1)) << exposure_us << ": but no later than the next tick";
    }
  }
}

TEST(Pictures, TheStampIsLateByItsOffset) {
  SimConfig config = config_of();
  CoreInTheTest exact(config);
  config.stamp_offset = Duration::from_us(-150);
  CoreInTheTest early(config);
  EXPECT_EQ(early.picture(0, 2000).image.exposure_start, exact.picture(0, 2000).image.exposure_start - Duration::from_us(150));
}

}  // namespace
}  // namespace lf::hal
