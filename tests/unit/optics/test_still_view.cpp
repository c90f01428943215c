// A frame is a kept still view with moving bodies and laser put in: it must be the frame that would be made from nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "host_sim/optics/still_view.hpp"
#include "shared/input_error.hpp"
#include "tests/arm5e_bodies.hpp"
#include "tests/unit/optics/mission_scene.hpp"

namespace lf::optics::test {
namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);  // null is not for memcmp
}

void expect_same(const Frame& a, const Frame& b) {
  EXPECT_TRUE(same_bytes(a.pixels, b.pixels));
  EXPECT_TRUE(same_bytes(a.depth_m, b.depth_m));
  EXPECT_TRUE(same_bytes(a.object, b.object));
  EXPECT_TRUE(same_bytes(a.stripe_v, b.stripe_v));
  EXPECT_TRUE(same_bytes(a.stripe_grey, b.stripe_grey));
}

// What stands about before the panel.
scene::Body post_before(const MissionScene& mission) {
  scene::Body post;
  post.name = "post";
  post.shapes.push_back(make_shape(scene::ShapeKind::box, {0.05, 0.05, 0.05}, Vec3::Zero(), 0.8f));
  post.base_from_body = mission.layout.nominal_base_from_panel() * Eigen::Translation3d(-0.1, -0.05, 0.1);
  return post;
}

// Any order of arm poses, handle and buttons, laser and lamps; now and then the panel itself moves, or a lamp's body.
void compare_with_fresh(OpticsConfig config, std::uint32_t seed, int frames) {
  const MissionScene mission;
  std::mt19937 random(seed);
  config.threads = 2;
  config.scene.push_back(post_before(mission));
  Optics kept(config);
  Frame frame, fresh_frame;
  scene::BodyPoses drift = scene::poses_at_origin(config.scene), undrifted = drift;
  for (int i = 0; i < frames; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", frame " + std::to_string(i));
    Shot shot;
    shot.frame_number = static_cast<std::uint64_t>(i);
    scene::BodyPoses now = mission.random_poses(random);
    now.push_back(config.scene.back().base_from_body);
    const bool touched = random() % 2 == 0;  // handle and buttons
    for (std::size_t body = 0; body < config.scene.size(); ++body) {
      if (i == 0 || touched || !yields(config.scene[body])) undrifted[body] = now[body];
    }
    shot.poses = undrifted;
    if (i % 7 == 5) drift[arm5e_body::panel] = Eigen::Translation3d(1e-9 * i, 0, 0) * Pose::Identity();
    if (i % 11 == 9) drift[arm5e_body::vehicle] = Eigen::Translation3d(0, 1e-3 * i, 0) * Pose::Identity();
    for (std::size_t body = 0; body < config.scene.size(); ++body) shot.poses[body] = drift[body] * shot.poses[body];
    shot.laser = random() % 3 != 0 ? 1.f : 0.f;
    shot.lamps = random() % 3 == 0 ? (random() % 2 == 0 ? 1.f : 0.4f) : 0.f;
    shot.time_s = i;
    shot.truth = true;
    kept.render(shot, frame);
    config.threads = 1;
    Optics fresh(config);
    fresh.render(shot, fresh_frame);
    expect_same(frame, fresh_frame);
  }
}

TEST(StillView, KeptOrMadeAnewGivesTheSameBytes) { compare_with_fresh(MissionScene().config(), 11, 24); }

TEST(StillView, KeptOrMadeAnewGivesTheSameBytesInColourThroughAPort) {
  OpticsConfig config = MissionScene().config();
  config.cameras[0].colour = true;
  config.cameras[0].port.emplace();
  config.cameras[0].intrinsics.width = 313;  // not a whole number of packets
  config.lamps[0].body = arm5e_body::wrist;
  compare_with_fresh(config, 12, 12);
}

TEST(StillView, AnObjectOfTheSceneIsSeenThrowsItsShadowAndBearsTheStripe) {
  const MissionScene mission;
  OpticsConfig config = mission.config();
  config.lamps.resize(1);  // alone its shadow is dark
  config.lamps[0].intensity_w_sr = {20, 20, 20};
  config.water.ambient_w_m2 = {0, 0, 0};
  config.water.attenuation_per_m = 0.05;
  const scene::Body post = post_before(mission);
  Shot shot;
  shot.poses = mission.poses({0, 0.3, 1.9, 0, 0.1}, 0, 0);
  shot.lamps = 1;
  shot.laser = 0;
  shot.truth = true;
  Frame without, with;
  Optics(config).render(shot, without);
  config.scene.push_back(post);
  EXPECT_THROW(Optics(config).render(shot, with), InputError) << "a pose is missing";
  shot.poses.push_back(post.base_from_body);
  Optics(config).render(shot, with);
  const auto label = static_cast<std::uint16_t>(1 + scene::own_body_count(config.scene));
  int seen = 0, darker = 0;
  for (std::size_t i = 0; i < with.object.size(); ++i) {
    seen += with.object[i] == label;
    darker += with.object[i] == without.object[i] && with.pixels[i] + 10 < without.pixels[i];
  }
  EXPECT_GT(seen, 100);
  EXPECT_GT(darker, 100);

  // Over a sweep the stripe comes by the object, and its true middle lies there.
  int stripes = 0;
  shot.lamps = 0, shot.laser = 1;
  Optics camera(config);
  for (double shoulder_rad = 0.7; shoulder_rad < 1.3; shoulder_rad += 0.02) {
    shot.poses = mission.poses({0, shoulder_rad, 1.40, 0, 0.3}, 0, 0);
    shot.poses.push_back(post.base_from_body);
    camera.render(shot, with);
    for (std::int32_t u = 0; u < with.width; ++u) {
      const float v = with.stripe_v[static_cast<std::size_t>(u)];
      if (std::isfinite(v)) stripes += with.object[static_cast<std::size_t>(std::lround(v) * with.width + u)] == label;
    }
  }
  EXPECT_GT(stripes, 50);
}

TEST(StillView, TwoCamerasKeepTheirOwn) {
  OpticsConfig config = MissionScene().config();
  config.cameras.push_back(config.cameras[0]);
  config.cameras[1].base_from_camera = looking({0.1, 0.3, -0.2}, {0.5, -0.3, 0.8});
  const MissionScene mission;
  std::mt19937 random(13);
  Optics both(config);
  Frame frame, fresh_frame;
  for (int i = 0; i < 6; ++i) {
    Shot shot;
    shot.camera = static_cast<std::size_t>(i % 2);
    shot.poses = mission.random_poses(random);
    both.render(shot, frame);
    Optics(config).render(shot, fresh_frame);
    expect_same(frame, fresh_frame);
  }
}

// The parts of the renderer about one camera, to ask what it leaves out.
struct Inside {
  explicit Inside(const OpticsConfig& config)
      : camera(config.cameras[0]),
        tiles(camera),
        bench(config.scene, config.water),
        arm(config.scene, moves),
        still(camera, tiles, config.scene, true),
        pool(1) {}
  void set_poses(const OpticsConfig& config, const scene::BodyPoses& poses) {
    bench.scene.set_poses(poses);
    bench.look.set_poses(poses);
    arm.set_poses(poses);
    bench.shader.lamps.clear();
    std::vector<scene::BodyId> lamp_bodies;
    for (const LampConfig& lamp : config.lamps) {
      bench.add(lamp, poses);
      lamp_bodies.push_back(lamp.body);
    }
    still.update(bench.shader, poses, lamp_bodies, 1, pool);
  }
  Camera camera;
  Tiles tiles;
  Bench bench;
  BodyBounds arm;
  StillView still;
  WorkerPool pool;
};

TEST(StillView, NoMovingBodyIsSeenOrCastsAShadowInATileThatIsNotAskedForThem) {
  const MissionScene mission;
  OpticsConfig config = mission.config();
  for (const bool port : {false, true}) {
    if (port) config.cameras[0].port.emplace();
    Inside inside(config);
    std::mt19937 random(14);
    std::size_t asked = 0, shown = 0, shaded = 0, of_tiles = 0;
    for (int arm = 0; arm < 12; ++arm) {
      const scene::BodyPoses poses = mission.random_poses(random);
      inside.set_poses(config, poses);
      for (int v = 0; v < inside.camera.height(); ++v) {
        for (int u = 0; u < inside.camera.width(); u += lane_count) {
          const std::size_t tile = inside.tiles.at(u, v);
          const bool may_be_seen = inside.arm.may_meet(inside.tiles.view(tile));
          const bool may_be_shaded = inside.still.may_be_shaded(tile, inside.arm);
          const RayPacket rays = inside.camera.row(u, v);
          const Sample still = inside.still.pixels().sample(inside.still.pixels().index(u, v));
          const HitPacket hit = inside.bench.scene.nearest(rays, still.hit);
          const bool seen = any(hit.parameter < still.hit.parameter);
          const LaneMask lit = inside.bench.shader.base(rays, still.hit, 1.f, {}, Casters::all).lit;
          const bool in_shadow = any(lit ^ still.lit);
          ASSERT_TRUE(may_be_seen || !seen) << "seed 14, arm " << arm << ", pixel " << u << " " << v;
          ASSERT_TRUE(may_be_shaded || !in_shadow) << "seed 14, arm " << arm << ", pixel " << u << " " << v;
          asked += may_be_seen, shown += seen, shaded += in_shadow, ++of_tiles;
        }
      }
    }
    EXPECT_GT(shown, 1000u);
    EXPECT_GT(shaded, 300u);
    EXPECT_LT(asked, of_tiles / 2);  // or it spares nothing
  }
}

TEST(StillView, TheScenesPartsAreTheWholeScene) {
  const MissionScene mission;
  const OpticsConfig config = mission.config();
  const Camera camera(config.cameras[0]);
  SplitScene parts(config.scene);
  std::mt19937 random(15);
  int hits = 0;
  for (int arm = 0; arm < 5; ++arm) {
    const scene::BodyPoses poses = mission.random_poses(random);
    parts.set_poses(poses);
    for (int v = 0; v < camera.height(); v += 3) {
      for (int u = 0; u < camera.width(); u += lane_count) {
        const RayPacket rays = camera.row(u, v);
        const HitPacket one = parts.all(rays);
        const HitPacket two = parts.nearest(rays, parts.resting(rays));
        for (int lane = 0; lane < lane_count; ++lane) {
          ASSERT_EQ(one.shape[lane] >= 0, two.shape[lane] >= 0) << "seed 15, pixel " << u + lane << " " << v;
          if (one.shape[lane] < 0) continue;
          ASSERT_NEAR(one.parameter[lane], two.parameter[lane], 1e-6) << "seed 15, pixel " << u + lane << " " << v;
          ++hits;
        }
      }
    }
  }
  EXPECT_GT(hits, 10000);
}

}  // namespace
}  // namespace lf::optics::test
