#include "firmware/scan_pipeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "firmware/arm/kinematics.hpp"
#include "firmware/scan/sweep.hpp"
#include "tests/unit/scan/docked_scene.hpp"
#include "tests/unit/scan/scan_bench.hpp"

namespace lf {
namespace {

using test::Angles;
using test::exposure;
using test::height;
using test::nominal_sweep;
using test::ScanBench;
using test::sync_period;
using test::width;

TEST(ScanPipelineTest, RebuildsThePanelFromImagesAndJoints) {
  std::mt19937_64 random(41);
  const Pose truth = test::docked_panel(random, 0.020, rad_from_deg(2));
  ScanBench bench(truth);
  const std::uint32_t images = bench.sweep(nominal_sweep());
  bench.command(ScanCommand::Kind::analyse, 7);
  PanelRequest request;
  ASSERT_TRUE(bench.pipeline().take_request(request));
  EXPECT_FALSE(bench.pipeline().take_request(request)) << "once only";
  EXPECT_EQ(request.id, 7u);
  EXPECT_FALSE(request.has_still);
  ASSERT_TRUE(request.fit.valid);
  const Vec3 normal = truth.linear().col(2);
  EXPECT_LT(request.fit.plane.normal.cross(normal).norm(), rad_from_deg(0.01));
  EXPECT_GT(request.fit.plane.normal.dot(normal), 0) << "toward the robot";
  EXPECT_NEAR(request.fit.plane.signed_distance_m(truth.translation()), 0, 0.0001);
  EXPECT_LT(request.fit.rms_m, 0.0002);
  EXPECT_GT(bench.pipeline().cloud().size(), 30'000u);
  const ScanStats& stats = bench.pipeline().stats();
  EXPECT_EQ(stats.points, bench.pipeline().cloud().size());
  EXPECT_GT(images, 100u);
  EXPECT_EQ(stats.images, images);
  EXPECT_EQ(stats.images_missing + stats.images_refused + stats.images_unexpected + stats.points_no_joints + stats.commands_refused, 0u);
}

class ScanOrders : public testing::Test {
 protected:
  void SetUp() override {
    bench_ = std::make_unique<ScanBench>(PanelLayout{}.nominal_base_from_panel());
    stripe_ = bench_->picture(q_, true);
    dark_ = bench_->picture(q_, false);
  }
  // Joint samples up to the given SYNC.
  void joints_until(int sync) {
    for (; next_ <= sync; ++next_) bench_->joints(ScanBench::time(next_), q_);
  }
  void begin() { bench_->command(ScanCommand::Kind::begin_sweep); }
  const ScanStats& stats() { return bench_->pipeline().stats(); }
  std::size_t points() { return bench_->pipeline().cloud().size(); }

  const Angles q_{0, 0.95, 1.5, 0};
  std::unique_ptr<ScanBench> bench_;
  std::vector<std::uint8_t> stripe_, dark_;
  int next_ = 0;
};

// What stands in the scene is on the background, too, and gives no peak as long as it is subtracted.
TEST_F(ScanOrders, ABackgroundServesForTwoRoundsAndNoLonger) {
  begin();
  int sync = 0;
  const auto peaks_of = [&](ExposureKind kind) {
    sync += 10;
    bench_->order(ScanBench::time(sync), kind);
    bench_->send(ScanBench::time(sync), stripe_);
    return bench_->pipeline().last_peaks().size();
  };
  const auto lose = [&] {
    sync += 10;
    bench_->order(ScanBench::time(sync), ExposureKind::background);
  };
  for (int sweep = 0; sweep < 2; ++sweep) {
    (void)peaks_of(ExposureKind::background);
    for (int frame = 1; frame < 5; ++frame) EXPECT_EQ(peaks_of(ExposureKind::laser_on), 0u) << frame;
    lose();
    for (int frame = 6; frame < 10; ++frame) EXPECT_EQ(peaks_of(ExposureKind::laser_on), 0u) << "one lost background is bridged, " << frame;
    lose();
    for (int frame = 11; frame < 15; ++frame) EXPECT_GT(peaks_of(ExposureKind::laser_on), 500u) << "it is too old, " << frame;
  }
}

// What one sweep has learned of the stripe is told with its answer, and forgotten at the next one's begin.
TEST_F(ScanOrders, TheStripesFormIsOfItsSweep) {
  EXPECT_EQ(stats().stripe.width_px, 0);
  StripeForm first;
  for (int sweep = 0; sweep < 2; ++sweep) {
    begin();
    EXPECT_EQ(stats().stripe.width_px, 0) << "sweep " << sweep;
    const int sync = 10 * (sweep + 1);
    bench_->order(ScanBench::time(sync), ExposureKind::laser_on);
    bench_->send(ScanBench::time(sync), stripe_);
    joints_until(sync + 8);
    EXPECT_GT(stats().stripe.width_px, 0.5) << "sweep " << sweep;
    EXPECT_LT(stats().stripe.width_px, 4) << "sweep " << sweep;
    EXPECT_GE(stats().stripe.model_share, scan::least_model_share);
    bench_->command(ScanCommand::Kind::analyse);
    PanelRequest request;
    ASSERT_TRUE(bench_->pipeline().take_request(request));
    // A skew is doubted by what was found of it, and by 0.05 at most on top: 3 widths each.
    const StripeForm& form = stats().stripe;
    const double found_px = form.width_px * (3 * std::abs(form.skew) + 2.4 * (form.model_share - scan::least_model_share));
    EXPECT_GT(request.fit.shape_shift_m, 0.95 * found_px * bench_->m_per_px(q_));
    EXPECT_LT(request.fit.shape_shift_m, 1.05 * (found_px + 3 * 0.05 * form.width_px) * bench_->m_per_px(q_));
    EXPECT_NEAR(request.fit.depth_m_per_rad, bench_->m_per_rad(q_), 0.01 * bench_->m_per_rad(q_));
    if (sweep == 0) first = stats().stripe;
    // The same picture, so the same is learned of it: by more than one picture of it, a little more would be.
    EXPECT_EQ(stats().stripe.width_px, first.width_px);
    EXPECT_EQ(stats().stripe.skew, first.skew);
  }
}

TEST_F(ScanOrders, AStripeWaitsForTheJointsAfterIt) {
  begin();
  joints_until(10);
  bench_->order(ScanBench::time(10), ExposureKind::laser_on);
  bench_->send(ScanBench::time(10), stripe_);
  EXPECT_GT(bench_->pipeline().last_peaks().size(), 500u);
  EXPECT_EQ(bench_->pipeline().last_peaks_time(), ScanBench::time(10) + exposure / 2);
  EXPECT_EQ(points(), 0u);
  joints_until(20);
  EXPECT_GT(points(), 400u);
}

TEST_F(ScanOrders, AnalyseTakesInWhatStillWaits) {
  begin();
  joints_until(10);
  bench_->order(ScanBench::time(10), ExposureKind::laser_on);
  bench_->send(ScanBench::time(10), stripe_);
  joints_until(12);
  EXPECT_EQ(points(), 0u);
  bench_->command(ScanCommand::Kind::end_sweep);
  bench_->command(ScanCommand::Kind::analyse);
  EXPECT_GT(points(), 400u);
  PanelRequest request;
  ASSERT_TRUE(bench_->pipeline().take_request(request));
  EXPECT_FALSE(request.fit.valid) << "one stripe is no plane";
}

// Three stripes whose joints come in one turn of the vision thread.
TEST_F(ScanOrders, EachOfSeveralStripesThatAreTakenInOneTurnCanBeRead) {
  begin();
  for (int sync = 10; sync <= 30; sync += 10) {
    bench_->order(ScanBench::time(sync), ExposureKind::laser_on);
    bench_->send(ScanBench::time(sync), stripe_);
  }
  EXPECT_EQ(bench_->pipeline().stripes_taken(), 0u);
  joints_until(40);
  ASSERT_EQ(bench_->pipeline().stripes_taken(), 3u);
  for (std::uint32_t number = 0; number < 3; ++number) {
    const auto [time, places_px] = bench_->pipeline().taken(number);
    EXPECT_EQ(time, ScanBench::time(10 * static_cast<int>(number + 1)) + exposure / 2);
    EXPECT_GT(places_px.size(), 400u) << "stripe " << number;
  }
}

TEST_F(ScanOrders, ImagesWithoutAnOrderAreUnexpected) {
  begin();
  joints_until(30);
  bench_->send(ScanBench::time(10), stripe_);
  bench_->order(ScanBench::time(20), ExposureKind::laser_on);
  bench_->send(ScanBench::time(20) + Duration::from_us(2100), stripe_);
  EXPECT_EQ(stats().images_unexpected, 2u);
  EXPECT_EQ(stats().images, 0u);
  bench_->send(ScanBench::time(20) - Duration::from_us(1900), stripe_);
  EXPECT_EQ(stats().images, 1u);
  bench_->send(ScanBench::time(20), stripe_);
  EXPECT_EQ(stats().images_unexpected, 3u) << "one image an order";
  EXPECT_EQ(points(), stats().points);
}

// Two pictures of too much light are alike, and yet the camera is alive.
TEST_F(ScanOrders, PicturesThatAreWhiteEverywhereAreNoFrozenCamera) {
  begin();
  for (int i = 1; i <= 3; ++i) bench_->order(ScanBench::time(10 * i), ExposureKind::laser_on);
  const std::vector<std::uint8_t> white(stripe_.size(), 255);
  for (int i = 1; i <= 3; ++i) bench_->send_just(ScanBench::time(10 * i), white);
  EXPECT_EQ(stats().images, 3u);
  EXPECT_EQ(stats().images_repeated, 0u);
}

TEST_F(ScanOrders, ThePictureBeforeOnceMoreIsRefused) {
  begin();
  for (int i = 1; i <= 4; ++i) bench_->order(ScanBench::time(10 * i), ExposureKind::laser_on);
  bench_->send(ScanBench::time(10), stripe_);
  bench_->send_again(ScanBench::time(20));
  bench_->send_again(ScanBench::time(30));
  EXPECT_EQ(stats().images, 1u);
  EXPECT_EQ(stats().images_repeated, 2u);
  EXPECT_EQ(stats().newest_exposure, ScanBench::time(10));
  bench_->send(ScanBench::time(40) + Duration::from_us(300), stripe_);
  EXPECT_EQ(stats().images, 2u);
  EXPECT_EQ(stats().newest_exposure, ScanBench::time(40)) << "as it was ordered";
}

TEST_F(ScanOrders, ADroppedExposureIsRefusedBeforeAndAfterItsImageCame) {
  begin();
  joints_until(10);
  bench_->order(ScanBench::time(5), ExposureKind::laser_on);
  bench_->drop(ScanBench::time(5));
  bench_->send(ScanBench::time(5), stripe_);
  EXPECT_EQ(stats().images_refused, 1u);
  bench_->order(ScanBench::time(10), ExposureKind::laser_on);
  bench_->send(ScanBench::time(10) + Duration::from_us(300), stripe_);
  bench_->drop(ScanBench::time(10));
  EXPECT_EQ(stats().images_refused, 2u);
  joints_until(30);
  EXPECT_EQ(points(), 0u);
  bench_->drop(ScanBench::time(11));
  EXPECT_EQ(stats().commands_refused, 1u) << "never ordered";
}

TEST_F(ScanOrders, ADroppedStillIsNotHandedOn) {
  begin();
  bench_->order(ScanBench::time(5), ExposureKind::still);
  bench_->send(ScanBench::time(5), dark_);
  EXPECT_TRUE(bench_->pipeline().has_still());
  bench_->drop(ScanBench::time(5));
  EXPECT_FALSE(bench_->pipeline().has_still());
}

TEST_F(ScanOrders, TheStillIsKeptForTheRequestWithItsTime) {
  begin();
  bench_->command(ScanCommand::Kind::end_sweep);
  bench_->order(ScanBench::time(5), ExposureKind::still);
  bench_->send(ScanBench::time(5), dark_);
  bench_->command(ScanCommand::Kind::analyse, 3);
  PanelRequest request;
  ASSERT_TRUE(bench_->pipeline().take_request(request));
  EXPECT_TRUE(request.has_still);
  EXPECT_EQ(request.still_time, ScanBench::time(5) + exposure / 2);
  const ImageView still = bench_->pipeline().still();
  EXPECT_TRUE(std::equal(bench_->sent().begin(), bench_->sent().end(), still.data));
}

TEST_F(ScanOrders, StripesAfterTheSweepsEndAreNotItsPoints) {
  begin();
  joints_until(10);
  bench_->order(ScanBench::time(8), ExposureKind::laser_on);
  bench_->command(ScanCommand::Kind::end_sweep);
  bench_->order(ScanBench::time(10), ExposureKind::laser_on);
  bench_->send(ScanBench::time(8), stripe_);
  joints_until(30);
  const std::size_t during = points();
  EXPECT_GT(during, 400u) << "ordered during the sweep, arrived after it";
  bench_->send(ScanBench::time(10), stripe_);
  joints_until(50);
  EXPECT_EQ(points(), during);
}

TEST_F(ScanOrders, ImagesThatNeverCameAreMissing) {
  begin();
  for (int i = 0; i < 3; ++i) bench_->order(ScanBench::time(10 * i), ExposureKind::laser_on);
  bench_->send(ScanBench::time(10), stripe_);  // the first is lost
  EXPECT_EQ(stats().images_missing, 1u);
  bench_->command(ScanCommand::Kind::analyse);
  EXPECT_EQ(stats().images_missing, 2u);
  for (int i = 0; i < 40; ++i) bench_->order(ScanBench::time(100 + 10 * i), ExposureKind::laser_on);
  EXPECT_EQ(stats().images_missing, 2u + 40u - 32u) << "the oldest give way";
}

TEST_F(ScanOrders, ImagesOfAnotherSizeAreRefused) {
  begin();
  for (const ImageView& view : {ImageView{}, ImageView{stripe_.data(), 320, 240, 320}, ImageView{stripe_.data(), width, height, 100}}) {
    const Time start = ScanBench::time(next_ += 10);
    bench_->order(start, ExposureKind::laser_on);
    bench_->pipeline().on_image(0, {.view = view, .exposure_start = start, .exposure = exposure});
  }
  EXPECT_EQ(stats().images_refused, 3u);
  bench_->pipeline().on_image(3,
                              {.view = {stripe_.data(), width, height, width}, .exposure_start = ScanBench::time(0), .exposure = exposure});
  EXPECT_EQ(stats().images_unexpected, 0u) << "another camera's";
}

TEST_F(ScanOrders, OrdersOutOfTheirTimesAndBadJointsAreRefused) {
  bench_->order(ScanBench::time(10), ExposureKind::laser_on);
  bench_->order(ScanBench::time(10), ExposureKind::laser_on);
  bench_->order(ScanBench::time(9), ExposureKind::laser_on);
  EXPECT_EQ(stats().commands_refused, 2u);
  bench_->joints(ScanBench::time(1), q_);
  bench_->joints(ScanBench::time(1), q_);
  bench_->joints(ScanBench::time(2), {0, std::numeric_limits<double>::quiet_NaN(), 0, 0});
  EXPECT_EQ(stats().commands_refused, 4u);
  ScanCommand unknown;
  unknown.kind = static_cast<ScanCommand::Kind>(77);
  bench_->pipeline().on_command(unknown);
  EXPECT_EQ(stats().commands_refused, 5u);
}

TEST_F(ScanOrders, StripesWithoutJointsAboutThemGiveNoPoints) {
  begin();
  joints_until(5);
  next_ = 20;  // 14 SYNCs are lost
  bench_->order(ScanBench::time(10), ExposureKind::laser_on);
  bench_->send(ScanBench::time(10), stripe_);
  joints_until(40);
  EXPECT_EQ(points(), 0u);
  EXPECT_EQ(stats().points_no_joints, stats().peaks);
}

// A laser makes one stripe, and a second one on a part before the panel. Of three in a column none is believed.
TEST_F(ScanOrders, OfThreeStripesInAColumnNoneIsBelieved) {
  std::vector<std::uint8_t> three = stripe_;
  for (const double elbow_rad : {1.4, 1.6}) {
    const std::vector<std::uint8_t> other = bench_->picture({0, 0.95, elbow_rad, 0}, true);
    std::transform(three.begin(), three.end(), other.begin(), three.begin(), [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); });
  }
  std::vector<std::size_t> points_of;
  for (const auto* picture : {&stripe_, &three}) {
    begin();
    const int sync = next_;
    bench_->order(ScanBench::time(sync + 10), ExposureKind::background);
    bench_->send(ScanBench::time(sync + 10), dark_);
    bench_->order(ScanBench::time(sync + 20), ExposureKind::laser_on);
    bench_->send(ScanBench::time(sync + 20), *picture);
    joints_until(sync + 40);
    points_of.push_back(points());
  }
  EXPECT_GT(points_of[0], 300u);
  EXPECT_GT(stats().peaks_ambiguous, 100u);
  EXPECT_LT(points_of[1], points_of[0] / 2);
}

TEST_F(ScanOrders, AFullCloudCountsWhatItLoses) {
  begin();
  for (int i = 0; i < 600; ++i) {
    joints_until(10 * i + 10);
    bench_->order(ScanBench::time(10 * i + 10), ExposureKind::laser_on);
    bench_->send(ScanBench::time(10 * i + 10), stripe_);
  }
  joints_until(6020);
  EXPECT_EQ(points(), full_scan.cloud_points);
  EXPECT_EQ(stats().points, full_scan.cloud_points);
  EXPECT_GT(stats().points_overflowed, 1000u);
  begin();
  EXPECT_EQ(points(), 0u);
}

}  // namespace
}  // namespace lf
