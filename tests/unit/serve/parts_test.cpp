// What `serve` is made of: the choice of nodes, the pace, what is overheard, the rings between world and renderer.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "firmware/arm/actuator.hpp"
#include "firmware/canopen/codec.hpp"
#include "host_sim/serve/node_set.hpp"
#include "host_sim/serve/overheard.hpp"
#include "host_sim/serve/pace.hpp"
#include "host_sim/serve/render_rings.hpp"
#include "host_sim/serve/served_camera.hpp"
#include "shared/can/can_map.hpp"
#include "shared/input_error.hpp"
#include "tests/arm5e.hpp"
#include "tests/arm5e_joints.hpp"

namespace lf::serve {
namespace {

Time ms(double t) { return Time::from_s(1e-3 * t); }

TEST(NodeSet, reads_lists_and_ranges) {
  EXPECT_EQ(NodeSet::parse("all").text(), "1, 2, 3, 4, 5, 6");
  EXPECT_EQ(NodeSet::parse("1-3,6").text(), "1, 2, 3, 6");
  EXPECT_EQ(NodeSet::parse("5").text(), "5");
  EXPECT_TRUE(NodeSet::parse("none").empty());
}

TEST(NodeSet, refuses_what_no_node_has) {
  for (const char* text : {"", "7", "0", "1-7", "3-1", "1,x", "1;2", "-1", "1-", ","})
    EXPECT_THROW(NodeSet::parse(text), InputError) << text;
}

TEST(Pace, holds_real_time_when_steps_begin_in_time) {
  Pace pace(ms(500));
  for (int i = 1; i <= 1000; ++i) {
    EXPECT_EQ(pace.due(), ms(500 + i));
    EXPECT_EQ(pace.begin(ms(500 + i + 0.5)), ms(i));
    EXPECT_FALSE(pace.second_report(ms(500 + i)) && pace.stats().seconds_not_held > 0);
  }
  EXPECT_TRUE(pace.stats().held());
  EXPECT_EQ(pace.stats().late_1_ms, 0u);
  EXPECT_EQ(pace.stats().seconds, 1u);
}

TEST(Pace, catches_up_a_short_delay_and_says_so) {
  Pace pace(ms(0));
  pace.begin(ms(1));
  pace.begin(ms(12));  // due at 2
  EXPECT_EQ(pace.due(), ms(3)) << "what is late is caught up";
  EXPECT_EQ(pace.stats().worst, Duration::from_ms(10));
  EXPECT_EQ(pace.stats().lost, Duration{});
  EXPECT_FALSE(pace.stats().held());
  EXPECT_FALSE(pace.second_report(ms(999)));
  const std::optional<std::string> report = pace.second_report(ms(1000));
  ASSERT_TRUE(report);
  EXPECT_NE(report->find("up to 10.0 ms"), std::string::npos) << *report;
  EXPECT_EQ(pace.stats().seconds_not_held, 1u);
}

TEST(Pace, loses_time_beyond_a_backlog_and_counts_it) {
  Pace pace(ms(0));
  pace.begin(ms(1));
  EXPECT_EQ(pace.begin(ms(1002)), ms(2));  // 1000 ms late: 100 are caught up
  EXPECT_EQ(pace.stats().lost, Duration::from_ms(900));
  EXPECT_EQ(pace.due(), ms(903));
  EXPECT_EQ(pace.clock_at(ms(2)), ms(902));
  EXPECT_EQ(pace.simulated_at(ms(902.4)), ms(2.4));
}

TEST(Pace, an_instant_between_steps_is_between_their_times) {
  Pace pace(ms(100));
  pace.begin(ms(101));
  EXPECT_EQ(pace.simulated_at(ms(101.25)), ms(1.25));
  EXPECT_EQ(pace.simulated_at(ms(100.5)), ms(1)) << "not before the last step";
  EXPECT_EQ(pace.simulated_at(ms(150)), ms(2)) << "not after the next";
}

CanFrame frame(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
  CanFrame f;
  f.id = id;
  f.length = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), f.data.begin());
  return f;
}

TEST(OverheardDrives, the_world_follows_a_real_drive_and_holds_before_it_spoke) {
  OverheardDrives drives(test::arm5e.model());
  EXPECT_EQ(drives.follow(2, 0.5).velocity_rad_s, 0);
  CanFrame tpdo = frame(0x183, {0x37, 0x02, 0, 0, 0, 0, 0, 0});
  canopen::put(tpdo, can_map::drive_tpdo1::position, arm::counts_from_rad(test::arm5e.joint(arm5e_joint::elbow), 1.2));
  drives.hear(tpdo, ms(4));
  ASSERT_TRUE(drives.position_rad(2));
  EXPECT_NEAR(*drives.position_rad(2), 1.2, 4e-4);  // half a count at the screw's ends
  EXPECT_GT(drives.follow(2, 1.19).velocity_rad_s, 0);
  EXPECT_LT(drives.follow(2, 1.21).velocity_rad_s, 0);
  EXPECT_LE(std::abs(drives.follow(2, 0.0).velocity_rad_s), test::arm5e.joint(arm5e_joint::elbow).velocity_rad_s)
      << "no faster than the joint can";
  tpdo.length = 7;
  canopen::put(tpdo, can_map::drive_tpdo1::position, 0);
  drives.hear(tpdo, ms(8));
  EXPECT_NEAR(*drives.position_rad(2), 1.2, 4e-4) << "a short frame is not believed";
}

TEST(OverheardDrives, a_real_drive_counts_from_where_its_homing_file_says) {
  OverheardDrives drives(test::arm5e.model(), {0, 0, -70'000, 0, 0});
  CanFrame tpdo = frame(0x183, {0x37, 0x02, 0, 0, 0, 0, 0, 0});
  canopen::put(tpdo, can_map::drive_tpdo1::position, arm::counts_from_rad(test::arm5e.joint(arm5e_joint::elbow), 1.2) - 70'000);
  drives.hear(tpdo, ms(4));
  ASSERT_TRUE(drives.position_rad(2));
  EXPECT_NEAR(*drives.position_rad(2), 1.2, 4e-4);
}

TEST(OverheardOutputs, a_changed_counter_is_an_exposure_at_the_next_sync) {
  OverheardOutputs outputs;
  const CanFrame sync = frame(0x080, {});
  outputs.hear(frame(0x186, {0x03, 0x00, 7, 0, 0}), ms(1));  // interlock closed; the node saw trigger 7 last
  outputs.hear(frame(0x206, {0x01, 7, 0xD0, 0x07}), ms(2));  // laser on, no trigger
  outputs.hear(sync, ms(4));
  EXPECT_FALSE(outputs.take_exposure());
  outputs.hear(frame(0x206, {0x01, 8, 0xD0, 0x07}), ms(5));
  EXPECT_FALSE(outputs.take_exposure()) << "not before the SYNC";
  outputs.hear(sync, ms(8));
  const std::optional<devices::Exposure> exposure = outputs.take_exposure();
  ASSERT_TRUE(exposure);
  EXPECT_EQ(exposure->start, ms(8));
  EXPECT_EQ(exposure->duration, Duration::from_us(2000));
  EXPECT_EQ(exposure->counter, 8);
  EXPECT_TRUE(exposure->laser);
  EXPECT_FALSE(exposure->lamps);
  outputs.hear(sync, ms(12));
  EXPECT_FALSE(outputs.take_exposure());
}

TEST(OverheardOutputs, an_open_interlock_keeps_the_laser_out_of_the_picture) {
  OverheardOutputs outputs;
  outputs.hear(frame(0x186, {0x01, 0x00, 0, 0, 0}), ms(1));
  outputs.hear(frame(0x206, {0x03, 1, 0xD0, 0x07}), ms(2));
  outputs.hear(frame(0x080, {}), ms(4));
  const std::optional<devices::Exposure> exposure = outputs.take_exposure();
  ASSERT_TRUE(exposure);
  EXPECT_FALSE(exposure->laser);
  EXPECT_TRUE(exposure->lamps);
}

TEST(RenderRings, shots_arrive_bit_for_bit) {
  optics::Shot shot;
  shot.laser = 0.8f, shot.lamps = 0.3f, shot.time_s = 12.3456789;
  shot.poses = scene::BodyPoses(scene::max_bodies);
  scene::BodyPoses& poses = shot.poses;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i] = Pose::Identity();
    poses[i].linear() = Eigen::AngleAxisd(0.1 * static_cast<double>(i) + 1e-9, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    poses[i].translation() = Vec3(0.1, -0.2, 1.0 / 3.0) * static_cast<double>(i);
  }
  RecordInfo info;
  info.sequence = 77;
  info.exposure_ns = 2'500'000;
  const optics::Shot back = unpack(info, pack(shot));
  ASSERT_EQ(back.poses.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_EQ(back.poses[i].matrix(), poses[i].matrix());
  EXPECT_EQ(back.laser, 0.8f);
  EXPECT_EQ(back.lamps, 0.3f);
  EXPECT_EQ(back.time_s, 12.3456789);
  EXPECT_EQ(back.frame_number, 77u);
  EXPECT_EQ(back.exposure, Duration::from_us(2500));
}

TEST(RenderRings, an_order_crosses_the_file_and_nothing_comes_back_by_itself) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / ("lf_rings_" + std::to_string(::getpid()));
  {
    RemoteRenderer remote(file.string());
    MappedFile other = map_render_rings(file.string());
    FrameRingReader reader(std::as_bytes(other.bytes().first(exposure_ring_bytes())));
    RecordInfo info;
    ExposurePayload payload;
    EXPECT_EQ(reader.take(info, std::as_writable_bytes(std::span(&payload, 1))), FrameRingReader::Answer::empty);
    PictureOrder order;
    order.shot.poses = scene::poses_at_origin(scene::bare_scene());
    order.shot.poses[3].translation() = Vec3(1, 2, 3);
    order.info.sequence = 42;
    order.info.flags = frame_laser;
    ASSERT_TRUE(remote.submit(order));
    ASSERT_EQ(reader.take(info, std::as_writable_bytes(std::span(&payload, 1))), FrameRingReader::Answer::record);
    EXPECT_EQ(info.kind, kind_exposure);
    EXPECT_EQ(info.sequence, 42u);
    EXPECT_EQ(unpack(info, payload).poses[3].translation(), Vec3(1, 2, 3));
    Picture picture;
    EXPECT_FALSE(remote.take(picture));
    FrameRingWriter pictures;
    ASSERT_TRUE(pictures.open(other.bytes().subspan(exposure_ring_bytes())));
    EXPECT_FALSE(remote.take(picture));
    const std::vector<std::uint8_t> pixels(640 * 480, 77);
    ASSERT_TRUE(pictures.write(info, std::as_bytes(std::span(pixels)), 1));
    ASSERT_TRUE(remote.take(picture));
    EXPECT_EQ(picture.info.sequence, 42u);
    EXPECT_EQ(picture.pixels, pixels);
  }
  std::filesystem::remove(file);
}

// Keeps what it is asked for, and has each picture at once.
class AskedRenderer : public FrameRenderer {
 public:
  bool submit(const PictureOrder& order) override {
    orders.push_back(order);
    ready = true;
    return true;
  }
  bool take(Picture& picture) override {
    if (!ready) return false;
    ready = false;
    picture.info = orders.back().info;
    return true;
  }
  std::vector<PictureOrder> orders;
  bool ready = false;
};

class CountingTarget : public FrameTarget {
 public:
  bool deliver(const RecordInfo&, std::span<const std::uint8_t>) override {
    ++frames;
    return true;
  }
  void set_away(bool) override {}
  int frames = 0;
};

struct CameraOnItsOwn {
  explicit CameraOnItsOwn(const hal::SimConfig& timing) : camera(renderer, target, timing) {}
  // One exposure from 4 ms on; the laser is on before `laser_off_ms`, the lamps from `lamps_on_ms` on. Returns when the picture came, ms.
  int expose(Duration exposure, int laser_off_ms, int lamps_on_ms) {
    Pace pace(Time{});
    scene::BodyPoses poses = scene::poses_at_origin(scene::bare_scene());
    for (int t = 1; t < 100; ++t) {
      if (t == 4) camera.expose({ms(4), exposure, 1, true, false});
      poses[0].translation().x() = t;
      camera.step(ms(t), {t <= laser_off_ms, t > lamps_on_ms}, poses, pace);
      if (target.frames > 0) return t;
    }
    return 0;
  }
  AskedRenderer renderer;
  CountingTarget target;
  ServedCamera camera;
};

TEST(ServedCamera, an_output_that_is_switched_meanwhile_lights_its_share) {
  hal::SimConfig timing;
  timing.exposure_delay = Duration::from_us(500);
  timing.stamp_offset = Duration::from_us(-100);
  CameraOnItsOwn served(timing);
  EXPECT_EQ(served.expose(Duration::from_ms(5), 8, 6), 4 + 30) << "of the latency that a configuration has by itself";
  ASSERT_EQ(served.renderer.orders.size(), 1u);
  const PictureOrder& order = served.renderer.orders[0];
  EXPECT_FLOAT_EQ(order.shot.laser, 3.5f / 5);  // open from 4.5 to 9.5 ms
  EXPECT_FLOAT_EQ(order.shot.lamps, 3.5f / 5);
  EXPECT_EQ(order.shot.exposure, Duration::from_ms(5));
  EXPECT_EQ(order.shot.poses[0].translation().x(), 7) << "at mid-exposure";
  EXPECT_DOUBLE_EQ(order.shot.time_s, 0.007);
  EXPECT_EQ(order.info.start_ns, ms(3.9).ns());
}

TEST(ServedCamera, delivers_no_picture_before_it_is_exposed) {
  hal::SimConfig timing;
  timing.image_latency = Duration();
  timing.exposure_delay = Duration::from_us(500);
  CameraOnItsOwn served(timing);
  EXPECT_EQ(served.expose(Duration::from_ms(12), 50, 50), 17) << "the step in which the shutter closes, at 16.5 ms";
}

// The far side of the rings, at a pace of its own.
class ScriptedRenderer {
 public:
  explicit ScriptedRenderer(const std::string& file)
      : mapped_(map_render_rings(file)), exposures_(std::as_bytes(mapped_.bytes().first(exposure_ring_bytes()))) {
    EXPECT_TRUE(pictures_.open(mapped_.bytes().subspan(exposure_ring_bytes())));
    (void)next();  // finds the ring
  }
  std::optional<RecordInfo> next() {
    RecordInfo info;
    ExposurePayload payload;
    if (exposures_.take(info, std::as_writable_bytes(std::span(&payload, 1))) != FrameRingReader::Answer::record) return std::nullopt;
    return info;
  }
  void deliver(const RecordInfo& info) { EXPECT_TRUE(pictures_.write(info, std::as_bytes(std::span(pixels_)), 1)); }

 private:
  MappedFile mapped_;
  FrameRingReader exposures_;
  FrameRingWriter pictures_;
  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(640 * 480, 50);
};

class RemoteRendererTest : public testing::Test {
 protected:
  RemoteRendererTest() { EXPECT_FALSE(remote.take(picture)); }  // finds the ring, too
  ~RemoteRendererTest() override { std::filesystem::remove(file); }
  bool submit(std::uint32_t sequence, Time start) {
    PictureOrder order;
    order.shot.poses = scene::poses_at_origin(scene::bare_scene());
    order.info.sequence = sequence;
    order.info.start_ns = start.ns();
    return remote.submit(order);
  }

  std::filesystem::path file = std::filesystem::temp_directory_path() / ("lf_remote_" + std::to_string(::getpid()));
  RemoteRenderer remote{file.string()};
  ScriptedRenderer renderer{file.string()};
  Picture picture;
};

TEST_F(RemoteRendererTest, takes_no_more_orders_than_can_come_in_time) {
  EXPECT_TRUE(submit(0, ms(0)));
  EXPECT_TRUE(submit(1, ms(40)));
  EXPECT_TRUE(submit(2, ms(80)));
  EXPECT_FALSE(submit(3, ms(120)));
  renderer.deliver(*renderer.next());
  EXPECT_FALSE(submit(4, ms(160))) << "not before it was fetched";
  ASSERT_TRUE(remote.take(picture));
  EXPECT_EQ(picture.info.sequence, 0u);
  EXPECT_TRUE(submit(5, ms(200)));
  EXPECT_EQ(renderer.next()->sequence, 1u);
  EXPECT_EQ(renderer.next()->sequence, 2u);
  EXPECT_EQ(renderer.next()->sequence, 5u) << "what was refused is not drawn";
}

TEST_F(RemoteRendererTest, does_not_wait_for_ever_for_what_a_renderer_lost) {
  for (std::uint32_t i = 0; i < 3; ++i) EXPECT_TRUE(submit(i, ms(40 * i)));
  EXPECT_FALSE(submit(3, ms(900)));
  for (int i = 0; i < 3; ++i) (void)renderer.next();  // and it dies
  EXPECT_TRUE(submit(4, ms(1100)));
  renderer.deliver(*renderer.next());
  ASSERT_TRUE(remote.take(picture));
  EXPECT_EQ(picture.info.sequence, 4u);
  EXPECT_TRUE(submit(5, ms(1110)) && submit(6, ms(1120)) && submit(7, ms(1130))) << "the ones before the fourth were lost";
}

// Four seconds of 25 pictures each, with a renderer that stands still for one second in the beginning and then needs 38 ms a picture.
TEST_F(RemoteRendererTest, is_on_time_again_after_a_renderer_fell_behind) {
  std::optional<RecordInfo> drawing;
  double drawn_ms = 1000;
  int refused = 0, late = 0, came = 0, late_at_the_end = 0;
  for (int t = 0; t < 4000; ++t) {
    if (t % 40 == 0 && !submit(static_cast<std::uint32_t>(t / 40), ms(t))) ++refused;
    if (drawing && t >= drawn_ms) {
      renderer.deliver(*drawing);
      drawing.reset();
    }
    if (!drawing) {
      drawing = renderer.next();
      drawn_ms = std::max(drawn_ms, double(t)) + 38;
    }
    while (remote.take(picture)) {
      ++came;
      const double took_ms = t - 1e-6 * static_cast<double>(picture.info.start_ns);
      late += took_ms > 200;  // stale_image_s
      late_at_the_end += took_ms > 200 && t > 2000;
    }
  }
  EXPECT_LE(late, 3) << "those that were under way when it stood still";
  EXPECT_EQ(late_at_the_end, 0);
  EXPECT_GE(came, 100 - 25 - 4);
  EXPECT_LE(refused, 25 + 4);
}

}  // namespace
}  // namespace lf::serve
