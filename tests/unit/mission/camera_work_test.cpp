#include "firmware/mission/camera_work.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "shared/can/can_map.hpp"

namespace lf::mission {
namespace {

constexpr Duration period = can_map::sync_period;

// An output node that does what the map says: what an RPDO asks acts at the next SYNC, and the report of the SYNC after that one is the first to show it.
class Bench {
 public:
  explicit Bench(const CameraWork::Config& config) : work(config), io_(make_io()) {
    io_.go_online();
    report();
  }

  void cycle() {
    now_ = now_ + period;
    report();  // the answer to the last SYNC
    ScanOrders orders;
    while (orders_full && orders.push_back({})) {
    }
    work.tick(now_, io_, orders);
    if (orders_full) orders.clear();
    for (const ScanCommand& order : orders) {
      all.push_back(order);
      if (order.kind == ScanCommand::Kind::exposure) coming_.push_back(order.exposure_start);
    }
    deliver();
    silences += work.take_silence();
    io_.step(now_);
    CanFrame rpdo;
    if (io_.make_rpdo(rpdo, can_map::io_node)) asked_ = rpdo;
    shown_next_ = {shown_next_[1], shown_next_[2], asked_};
    if (break_at_cycle == cycles_) interlock_ = false;
    ++cycles_;
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) cycle();
  }

  int count(ScanCommand::Kind kind) const {
    int n = 0;
    for (const ScanCommand& order : all) n += order.kind == kind;
    return n;
  }

  CameraWork work;
  std::vector<ScanCommand> all;
  int break_at_cycle = -1;
  int images_to_lose = 0;
  bool orders_full = false;
  int silences = 0;
  Time now() const { return now_; }
  const canopen::IoModule& io() const { return io_; }

 private:
  static canopen::IoModule make_io() {
    canopen::NetworkConfig config;
    return canopen::IoModule(config);
  }

  // Images come 30 ms after their exposure.
  void deliver() {
    if (coming_.empty() || now_ < coming_.front() + Duration::from_ms(30)) return;
    if (images_to_lose > 0) {
      --images_to_lose;
    } else {
      work.on_image(coming_.front());
    }
    coming_.erase(coming_.begin());
  }

  void report() {
    const CanFrame& shown = shown_next_[0];
    std::uint8_t outputs = shown.data[0];
    if (!interlock_) outputs = static_cast<std::uint8_t>(outputs & ~can_map::output_laser);
    CanFrame tpdo;
    tpdo.id = 0x180u + can_map::io_node;
    tpdo.length = canopen::IoModule::tpdo_length;
    tpdo.data[0] = static_cast<std::uint8_t>(can_map::input_estop_closed | (interlock_ ? can_map::input_interlock_closed : 0));
    tpdo.data[1] = outputs;
    tpdo.data[2] = shown.data[1];
    tpdo.data[3] = shown.data[2];
    tpdo.data[4] = shown.data[3];
    io_.on_tpdo(tpdo, now_ - period);
  }

  canopen::IoModule io_;
  Time now_ = Time::from_s(1);
  CanFrame asked_;
  std::array<CanFrame, 3> shown_next_{};
  bool interlock_ = true;
  int cycles_ = 0;
  std::vector<Time> coming_;
};

TEST(CameraWork, SweepsAtTwentyFiveHertzWithEveryFifthFrameDark) {
  Bench bench({});
  bench.work.set_mode(CameraWork::Mode::sweep, bench.now());
  bench.run(500);  // 2 s
  std::vector<ExposureKind> kinds;
  for (const ScanCommand& order : bench.all) {
    if (order.kind == ScanCommand::Kind::exposure) kinds.push_back(order.exposure_kind);
  }
  ASSERT_EQ(kinds.size(), 50u);
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    EXPECT_EQ(kinds[i], i % 5 == 0 ? ExposureKind::background : ExposureKind::laser_on) << i;
  }
  EXPECT_EQ(bench.count(ScanCommand::Kind::drop_exposure), 0);
}

TEST(CameraWork, AnExposureIsDueAtTheNextSync) {
  Bench bench({});
  bench.work.set_mode(CameraWork::Mode::sweep, bench.now());
  Time asked;
  while (bench.all.empty()) {
    bench.cycle();
    asked = bench.now();
  }
  EXPECT_EQ(bench.all.front().exposure_start.ns(), (asked + period).ns());
}

TEST(CameraWork, FramesWhoseLaserWasNotAsAskedAreDropped) {
  Bench bench({});
  bench.work.set_mode(CameraWork::Mode::sweep, bench.now());
  bench.break_at_cycle = 100;
  bench.run(250);
  EXPECT_TRUE(bench.work.laser_inhibited() || bench.count(ScanCommand::Kind::drop_exposure) > 0);
  // Dark frames are still good: only laser-on ones are dropped.
  int laser_frames_after = 0;
  for (const ScanCommand& order : bench.all) {
    const bool after = order.exposure_start > Time::from_s(1) + period * 103;
    laser_frames_after += order.kind == ScanCommand::Kind::exposure && order.exposure_kind == ExposureKind::laser_on && after;
  }
  EXPECT_GT(laser_frames_after, 0);
  EXPECT_GE(bench.count(ScanCommand::Kind::drop_exposure), laser_frames_after - 1);
}

TEST(CameraWork, AStillIsTakenOnceWithLampsAndWithoutLaser) {
  Bench bench({});
  bench.work.set_mode(CameraWork::Mode::still, bench.now());
  EXPECT_FALSE(bench.work.still_taken());
  bench.run(100);
  EXPECT_TRUE(bench.work.still_taken());
  EXPECT_EQ(bench.count(ScanCommand::Kind::exposure), 1);
  EXPECT_EQ(bench.io().wanted_outputs(), can_map::output_lamps);
}

TEST(CameraWork, AnImageThatIsLostIsCountedAndTheNextIsWaitedFor) {
  Bench bench({});
  bench.work.set_mode(CameraWork::Mode::sweep, bench.now());
  bench.run(50);
  bench.images_to_lose = 1;
  bench.run(200);
  EXPECT_EQ(bench.work.images_lost(), 1u);
  EXPECT_EQ(bench.silences, 0);
}

TEST(CameraWork, ACameraWithoutImagesIsSilentAfterTheStaleTime) {
  Bench bench({});
  bench.work.set_mode(CameraWork::Mode::sweep, bench.now());
  bench.images_to_lose = 1000;
  bench.run(10 + 50);  // the first exposure comes with the tenth SYNC
  EXPECT_EQ(bench.silences, 0);
  bench.run(5);
  EXPECT_EQ(bench.silences, 1);
  bench.images_to_lose = 0;
  bench.run(100);
  EXPECT_EQ(bench.silences, 1) << "it is back";
}

// The vision thread is told of no exposure: its picture would be one without an order.
TEST(CameraWork, AnExposureThatCannotBeOrderedIsDropped) {
  Bench bench({});
  bench.work.set_mode(CameraWork::Mode::sweep, bench.now());
  bench.orders_full = true;
  bench.run(100);
  EXPECT_EQ(bench.work.dropped(), bench.work.exposures());
  EXPECT_GT(bench.work.dropped(), 5u);
  EXPECT_EQ(bench.work.images_lost(), 0u) << "nothing is waited for";
  bench.orders_full = false;
  bench.run(100);
  EXPECT_LT(bench.work.dropped(), bench.work.exposures());
}

// 32 exposures are waited for. Of a camera that is as slow as this the oldest is given up, and counted.
TEST(CameraWork, OfMorePicturesThanAreWaitedForTheOldestIsLost) {
  CameraWork::Config config;
  config.camera_syncs = 2;
  config.stale_image = Duration::from_ms(2000);
  Bench bench(config);
  bench.work.set_mode(CameraWork::Mode::sweep, bench.now());
  bench.images_to_lose = 1000;
  bench.run(2 * 42);
  EXPECT_EQ(bench.work.exposures(), 42u);
  EXPECT_EQ(bench.work.images_lost(), 10u);
}

TEST(CameraWork, TheLastImageOfASweepMayBeLost) {
  Bench bench({});
  bench.work.set_mode(CameraWork::Mode::sweep, bench.now());
  bench.run(105);
  bench.work.set_mode(CameraWork::Mode::idle, bench.now());
  bench.images_to_lose = 1;
  bench.run(30);
  bench.work.set_mode(CameraWork::Mode::still, bench.now());
  bench.run(100);
  EXPECT_EQ(bench.work.images_lost(), 1u);
  EXPECT_EQ(bench.silences, 0);
  EXPECT_TRUE(bench.work.still_taken());
}

TEST(CameraWork, AStillWhoseImageDoesNotComeIsNotTaken) {
  Bench bench({});
  bench.work.set_mode(CameraWork::Mode::still, bench.now());
  bench.images_to_lose = 1;
  bench.run(150);
  EXPECT_FALSE(bench.work.still_taken());
  EXPECT_EQ(bench.silences, 1);
  bench.work.set_mode(CameraWork::Mode::still, bench.now());
  bench.run(100);
  EXPECT_TRUE(bench.work.still_taken());
}

TEST(CameraWork, InIdleItIsDarkAndTakesNothingUnlessAskedToRunAlways) {
  Bench idle({});
  idle.run(100);
  EXPECT_EQ(idle.all.size(), 0u);
  EXPECT_EQ(idle.io().wanted_outputs(), 0);

  CameraWork::Config config;
  config.always_on = true;
  Bench always(config);
  always.run(100);
  EXPECT_EQ(always.count(ScanCommand::Kind::exposure), 10);
  for (const ScanCommand& order : always.all) EXPECT_EQ(order.exposure_kind, ExposureKind::monitor);
}

}  // namespace
}  // namespace lf::mission
