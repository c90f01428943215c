// The served hardware under the real core, on a wire and a clock of the test's own: the mission has to come out as in the lockstep simulation.
#include <gtest/gtest.h>

#include <deque>
#include <functional>

#include "hal/lockstep.hpp"
#include "hal/vision/panel_vision.hpp"
#include "host_sim/scenario/instance.hpp"
#include "host_sim/serve/serve_loop.hpp"
#include "host_sim/serve/serve_result.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/serve/virtual_wire.hpp"

namespace lf::serve {
namespace {

// Renders when it is asked: virtual time waits for it.
class PromptRenderer : public FrameRenderer {
 public:
  explicit PromptRenderer(const optics::OpticsConfig& config) : optics_(config) {}
  bool submit(const PictureOrder& order) override {
    optics::Frame frame;
    optics_.render(order.shot, frame);
    Picture picture{order.info, frame.pixels};
    fill_size(picture.info, frame);
    pictures_.push_back(std::move(picture));
    return true;
  }
  bool take(Picture& picture) override {
    if (pictures_.empty()) return false;
    picture = std::move(pictures_.front());
    pictures_.pop_front();
    return true;
  }

 private:
  optics::Optics optics_;
  std::deque<Picture> pictures_;
};

class MemoryTarget : public FrameTarget {
 public:
  bool deliver(const RecordInfo& info, std::span<const std::uint8_t> pixels) override {
    if (away) return false;
    frames.push_back({info, {pixels.begin(), pixels.end()}});
    return true;
  }
  void set_away(bool a) override { away = a; }
  std::deque<Picture> frames;
  bool away = false;
};

struct Job {
  explicit Job(const std::string& name, std::uint64_t seed, const std::vector<std::string>& set = {})
      : scenario(scenario::load_scenario(name, set)),
        sample(scenario::draw(scenario, seed)),
        nominal(scenario::make_nominal(scenario, sample.lamps_lit)),
        sim(scenario::make_truth(scenario, sample, nominal, 1)) {}
  scenario::Scenario scenario;
  scenario::Sample sample;
  scenario::Nominal nominal;
  hal::SimConfig sim;
};

// The master's platform: a tick is four turns of everything that is served.
class WirePlatform : public hal::Unattended {
 public:
  WirePlatform(const Job& job, test::Wire& wire, test::VirtualClock& clock, MemoryTarget& camera, std::function<void()> turn)
      : config_(job.sim), clock_(clock), plug_(wire, clock), camera_(camera), turn_(std::move(turn)), vision_(job.sim.vision) {}

  hal::PortStatus wait_for_tick(Time& tick) {
    for (int i = 0; i < 4; ++i) turn_();
    tick = clock_.now;
    return hal::port_ok;
  }
  hal::PortStatus receive_can(std::uint8_t, hal::ReceivedFrame& received) { return plug_.receive(received); }
  hal::PortStatus send_can(std::uint8_t, std::span<const CanFrame> frames) { return plug_.send(frames); }
  hal::PortStatus receive_image(std::uint8_t, Image& image) {
    if (camera_.frames.empty()) return hal::port_empty;
    picture_ = std::move(camera_.frames.front());
    camera_.frames.pop_front();
    image.view = {picture_.pixels.data(), picture_.info.width, picture_.info.height, picture_.info.stride};
    image.exposure_start = Time::from_ns(picture_.info.start_ns);
    image.exposure = Duration::from_ns(picture_.info.exposure_ns);
    image.sequence = picture_.info.sequence;
    image.trigger = picture_.info.trigger;
    return hal::port_ok;
  }
  hal::PortStatus submit_panel(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) {
    vision_.submit(vision::PanelJob::copy(request, still, cloud));
    due_ = clock_.now + config_.vision_latency;
    return hal::port_ok;
  }
  hal::PortStatus receive_panel(PanelResult& result) {
    if (!due_ || clock_.now < *due_) return hal::port_empty;
    due_.reset();
    return vision_.wait(result) ? hal::port_ok : hal::port_empty;
  }
  hal::PortStatus publish(const Telemetry& telemetry) {
    last = telemetry;
    return hal::port_ok;
  }
  Telemetry last;

 private:
  const hal::SimConfig& config_;
  test::VirtualClock& clock_;
  test::Wire::Plug plug_;
  MemoryTarget& camera_;
  std::function<void()> turn_;
  vision::PanelVisionWorker vision_;
  std::optional<Time> due_;
  Picture picture_;
};

TEST(ServedMission, turns_the_valve_by_the_worlds_own_account) {
  const Job job("turn_only", 11);
  test::VirtualClock clock;
  test::Wire wire;
  test::Wire::Plug nodes(wire, clock);
  PromptRenderer renderer(job.sim.optics);
  MemoryTarget target;
  ServedCamera camera(renderer, target, job.sim);
  std::vector<std::string> said;
  ServeLoop loop(job.sim, NodeSet::all(), nodes, &camera, [&](const std::string& line) { said.push_back(line); });
  WirePlatform platform(job, wire, clock, target, [&] { loop.turn(); });
  hal::Lockstep<WirePlatform> core(platform, job.nominal.controller, job.nominal.scan);
  core.controller().on_command(Command::start, {});
  while (!core.ended() && clock.now.s() < job.scenario.time_limit_s) core.step();
  const ServeResult result = make_result(loop, &camera, job.nominal.controller.mission, job.scenario.survey.names);
  EXPECT_TRUE(core.controller().mission().outcome().success);
  EXPECT_TRUE(result.success) << serve_result_json(result);
  EXPECT_TRUE(result.pace.held());
  EXPECT_EQ(result.camera->exposures, result.camera->frames);
  EXPECT_GT(result.camera->frames, 300u);
  EXPECT_EQ(result.contact.unintended_contacts, 0u);
  EXPECT_TRUE(said.empty()) << testing::PrintToString(said);
}

// Drives in one loop stand for the real ones; the other serves the outputs and the camera, and its world follows them.
TEST(ServedMission, a_world_whose_drives_are_real_follows_them) {
  const Job job("default", 11);
  test::VirtualClock clock;
  test::Wire wire;
  test::Wire::Plug drives_plug(wire, clock), outputs_plug(wire, clock);
  ServeLoop real(job.sim, NodeSet::parse("1-5"), drives_plug, nullptr, {});
  ServeLoop followed(job.sim, NodeSet::parse("6"), outputs_plug, nullptr, {});
  MemoryTarget target;
  WirePlatform platform(job, wire, clock, target, [&] {
    real.turn();
    followed.turn();
  });
  hal::Lockstep<WirePlatform> core(platform, job.nominal.controller, job.nominal.scan);
  core.controller().on_command(Command::start, {});
  double travelled_rad = 0, worst_rad = 0;
  const double start_rad = real.world().readings()[1].position_rad;
  while (clock.now.s() < 6) {  // the jaw is looked at for 1.4 s first
    core.step();
    for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i) {
      // Encoder offsets are part of what a drive reports: the follower stands where the drive says, which is that far off.
      const double offset = job.sample.joint_offset_rad[i];
      worst_rad =
          std::max(worst_rad, std::abs(real.world().readings()[i].position_rad + offset - followed.world().readings()[i].position_rad));
    }
    travelled_rad = std::max(travelled_rad, std::abs(real.world().readings()[1].position_rad - start_rad));
  }
  EXPECT_GT(travelled_rad, 0.3) << "the arm moved";
  // A count of the coarsest drive, the roll, is 3 mrad.
  EXPECT_LT(worst_rad, 0.003);
}

TEST(ServedMission, a_bus_that_fails_is_said_once_and_time_goes_on) {
  const Job job("default", 1);
  test::VirtualClock clock;
  test::Wire wire;
  test::Wire::Plug nodes(wire, clock), other(wire, clock);
  std::vector<std::string> said;
  ServeLoop loop(job.sim, NodeSet::all(), nodes, nullptr, [&](const std::string& line) { said.push_back(line); });
  const CanFrame frame{.id = 0x080, .length = 0};
  for (int i = 0; i < 10; ++i) loop.turn();
  nodes.error = 100;  // ENETDOWN
  for (int i = 0; i < 100; ++i) {
    (void)other.send(std::span(&frame, 1));
    loop.turn();
  }
  nodes.error = 0;
  for (int i = 0; i < 10; ++i) loop.turn();
  EXPECT_EQ(loop.simulated(), Time::from_s(0.120));
  ASSERT_EQ(said.size(), 2u) << testing::PrintToString(said);
  EXPECT_EQ(said[1], "the bus is back");
}

}  // namespace
}  // namespace lf::serve
