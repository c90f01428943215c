// The whole bench over its front door: bus, six nodes, faults, the figure of the bus load.
#include "host_sim/devices/devices.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "shared/input_error.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/unit/devices/drive/drive_rig.hpp"

namespace lf::devices::test {
namespace {

DevicesConfig bench_config() {
  return devices_config(load_arm_urdf(std::string(LANTERNFISH_SOURCE_DIR) + "/shared/arm/arm5e.urdf"), {}, 42);
}

class Bench {
 public:
  explicit Bench(const DevicesConfig& config = bench_config()) : devices(config) {
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
      joints[i].lower_rad = config.drives[i].lower_rad;
      joints[i].upper_rad = config.drives[i].upper_rad;
      joints[i].q_rad = 0.5 * (config.drives[i].lower_rad + config.drives[i].upper_rad);
    }
    devices.set_tap([this](const BusRecord& r) {
      log.push_back(r);
      ids[r.frame.id]++;
    });
  }

  void send(std::uint32_t id, std::vector<std::uint8_t> data) {
    CanFrame f;
    f.id = id;
    f.length = static_cast<std::uint8_t>(data.size());
    std::copy(data.begin(), data.end(), f.data.begin());
    devices.master_sends(f, now);
  }
  void write(std::uint8_t node, std::uint16_t index, std::uint8_t sub, std::uint32_t value, std::size_t bytes) {
    std::vector<std::uint8_t> data{static_cast<std::uint8_t>(0x23 | ((4 - bytes) << 2)), static_cast<std::uint8_t>(index & 0xFF),
                                   static_cast<std::uint8_t>(index >> 8), sub};
    for (int i = 0; i < 4; ++i) data.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    send(0x600u + node, data);
    run_ms(2);
  }
  void map(std::uint8_t node, std::uint16_t communication, std::uint32_t cob_id, const std::vector<std::uint32_t>& entries) {
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    write(node, communication, 1, cob_id | 0x80000000u, 4);
    write(node, communication, 2, 1, 1);
    write(node, mapping, 0, 0, 1);
    for (std::size_t i = 0; i < entries.size(); ++i) write(node, mapping, static_cast<std::uint8_t>(i + 1), entries[i], 4);
    write(node, mapping, 0, static_cast<std::uint32_t>(entries.size()), 1);
    write(node, communication, 1, cob_id, 4);
  }

  // What a mission's master does at boot, by hand.
  void configure(bool with_outputs = true) {
    run_ms(200);
    for (const std::uint8_t node : can_map::drive_nodes) {
      map(node, 0x1400, 0x200u + node, {0x60400010, 0x607A0020, 0x60B20010});
      map(node, 0x1800, 0x40000180u + node, {0x60410010, 0x60640020, 0x60770010});
      for (std::uint16_t i = 1; i < 4; ++i) {
        write(node, static_cast<std::uint16_t>(0x1400 + i), 1, 0x80000000, 4);
        write(node, static_cast<std::uint16_t>(0x1800 + i), 1, 0xC0000000, 4);
      }
      write(node, 0x60C2, 1, 4, 1);
      write(node, 0x6060, 0, 8, 1);
    }
    if (with_outputs) {
      map(6, 0x1400, 0x206, {0x62000108, 0x21000108, 0x21000210});
      map(6, 0x1800, 0x40000186, {0x60000108, 0x21010108, 0x21010208, 0x21010310});
    } else {
      write(6, 0x1800, 1, 0xC0000000, 4);
    }
    for (std::uint8_t node = 1; node <= 6; ++node) {
      write(node, 0x1016, 1, (0x7Fu << 16) | 300, 4);
      write(node, 0x1017, 0, 100, 2);
    }
    send(0, {1, 0});
    outputs = with_outputs;
    cyclic = true;
  }

  void step() {
    if (ms % 4 == 0 && cyclic) {
      send(0x80, {});
      for (std::size_t i = 0; i < arm5e_joint::count; ++i) {
        const auto t = static_cast<std::uint32_t>(targets[i]);
        send(0x201u + static_cast<std::uint32_t>(i),
             {static_cast<std::uint8_t>(controlword), static_cast<std::uint8_t>(controlword >> 8), static_cast<std::uint8_t>(t),
              static_cast<std::uint8_t>(t >> 8), static_cast<std::uint8_t>(t >> 16), static_cast<std::uint8_t>(t >> 24), 0, 0});
      }
      if (outputs) send(0x206, {output, trigger, 0xD0, 0x07});
    }
    if (beats && ms % 100 == 0) send(0x77F, {5});
    ++ms;
    now = Time::from_ns(ms * 1'000'000);
    JointReadings readings;
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) readings[i] = joints[i].reading();
    devices.step(now, readings);
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) joints[i].step(devices.drives()[i]);
    CanFrame f;
    Time at;
    while (devices.next_to_master(f, at)) {
      EXPECT_LE(at, now);
      received.push_back({f, at, 0});
      if (f.id > 0x180 && f.id < 0x186) {
        status[f.id - 0x181] = static_cast<std::uint16_t>(f.data[0] | (f.data[1] << 8));
        actual[f.id - 0x181] = static_cast<std::int32_t>(Client::u32(f, 2));
      }
    }
  }
  void run_ms(int count) {
    for (int i = 0; i < count; ++i) step();
  }
  void enable() {
    configure();
    run_ms(20);
    targets = actual;
    for (const int word : {0x06, 0x07, 0x0F}) {
      controlword = static_cast<std::uint16_t>(word);
      run_ms(16);
    }
  }
  int emergency_of(std::uint8_t node) const {
    int code = -1;
    for (const BusRecord& r : received) {
      if (r.frame.id == 0x80u + node) code = r.frame.data[0] | (r.frame.data[1] << 8);
    }
    return code;
  }

  Devices devices;
  PerJoint<ScriptedJoint> joints;
  Time now;
  std::int64_t ms = 0;
  bool cyclic = false, outputs = true, beats = true;
  std::uint16_t controlword = 0;
  std::uint8_t output = 0, trigger = 0;
  PerJoint<std::int32_t> targets{}, actual{};
  PerJoint<std::uint16_t> status{};
  std::vector<BusRecord> log, received;
  std::map<std::uint32_t, int> ids;
};

TEST(Devices, six_nodes_boot_and_say_so) {
  Bench bench;
  bench.run_ms(149);
  EXPECT_TRUE(bench.received.empty());
  bench.run_ms(10);
  for (std::uint32_t node = 1; node <= 6; ++node) EXPECT_EQ(bench.ids[0x700 + node], 1) << node;
}

TEST(Devices, five_axes_at_250_hz_load_the_bus_by_less_than_the_worst_case_of_35_5_percent) {
  Bench bench;
  bench.configure(false);
  bench.run_ms(100);
  bench.log.clear();
  const std::uint64_t before = bench.devices.bus().bits;
  bench.run_ms(1000);
  const double load = static_cast<double>(bench.devices.bus().bits - before) / 1e6 * 100;
  EXPECT_LT(load, 35.5);
  EXPECT_GT(load, 100e-6 * (250 * (10 * (47 + 64) + 47) + 60 * 55)) << "what the same frames take without any stuffing";
}

TEST(Devices, every_answer_comes_before_the_next_tick) {
  Bench bench;
  bench.enable();
  bench.log.clear();
  bench.run_ms(400);
  Time sync;
  int answers = 0;
  for (const BusRecord& r : bench.log) {
    if (r.frame.id == 0x80) sync = r.delivered;
    if (r.frame.id < 0x181 || r.frame.id > 0x186) continue;
    ++answers;
    EXPECT_LT(r.delivered - sync, Duration::from_us(3500));
  }
  EXPECT_EQ(answers, 600);
  EXPECT_LT(bench.devices.bus().peak_load_percent, 42);
}

TEST(Devices, five_axes_run_to_their_targets_over_the_bus_alone) {
  Bench bench;
  bench.enable();
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) ASSERT_EQ(bench.status[i] & 0x6F, 0x27) << i;
  const PerJoint<std::int32_t> goal{bench.targets[0] + 200, bench.targets[1] - 300, bench.targets[2] + 150, bench.targets[3] + 40,
                                    bench.targets[4] - 120};
  for (int k = 0; k < 400; ++k) {
    for (std::size_t i = 0; i < arm5e_joint::count; ++i) bench.targets[i] += std::clamp(goal[i] - bench.targets[i], -1, 1);
    bench.run_ms(4);
  }
  bench.run_ms(800);
  for (std::size_t i = 0; i < arm5e_joint::count; ++i) EXPECT_LE(std::abs(bench.actual[i] - goal[i]), 2) << i;
}

TEST(Devices, the_camera_is_exposed_at_the_syncs_last_bit) {
  Bench bench;
  bench.enable();
  bench.output = can_map::output_laser;
  bench.trigger = 9;
  bench.log.clear();
  bench.run_ms(8);
  Time second_sync;
  for (const BusRecord& r : bench.log) {
    if (r.frame.id == 0x80) second_sync = r.delivered;
  }
  const std::optional<Exposure> e = bench.devices.take_exposure();
  ASSERT_TRUE(e.has_value());
  EXPECT_EQ(e->start, second_sync);
  EXPECT_EQ(e->duration, Duration::from_us(2000));
  EXPECT_TRUE(e->laser);
  EXPECT_TRUE(bench.devices.laser_on());
}

DevicesConfig with_fault(DeviceFaultKind kind, std::uint8_t node, double duration_s = 0, std::uint32_t id = 0) {
  DevicesConfig config = bench_config();
  config.faults.push_back({2.0, kind, node, duration_s, id});
  return config;
}

TEST(Devices, drive_faults_come_at_their_time_with_their_code) {
  const std::pair<DeviceFaultKind, int> table[] = {{DeviceFaultKind::overcurrent, 0x2310}, {DeviceFaultKind::hot, 0x4210}};
  for (const auto& [kind, code] : table) {
    Bench bench(with_fault(kind, 2, 0.1));
    bench.enable();
    bench.run_ms(static_cast<int>(1999 - bench.ms));
    EXPECT_EQ(bench.emergency_of(2), -1);
    bench.run_ms(20);
    EXPECT_EQ(bench.emergency_of(2), code);
    EXPECT_EQ(bench.emergency_of(1), -1);
  }
}

TEST(Devices, a_silent_node_stops_talking_and_faults_on_its_own) {
  Bench bench(with_fault(DeviceFaultKind::silent, 4, 1.0));
  bench.enable();
  bench.run_ms(static_cast<int>(2010 - bench.ms));
  bench.ids.clear();
  bench.run_ms(900);
  EXPECT_EQ(bench.ids[0x184], 0);
  EXPECT_EQ(bench.ids[0x704], 0);
  EXPECT_FALSE(bench.devices.drives()[3].released) << "the brake holds: 6007 is 1, 605E is 1";
  EXPECT_EQ(bench.devices.drives()[3].velocity_rad_s, 0);
  bench.run_ms(300);
  EXPECT_GT(bench.ids[0x704], 0) << "back again";
}

TEST(Devices, a_node_that_reboots_says_so_and_is_disabled) {
  Bench bench(with_fault(DeviceFaultKind::reboot, 5));
  bench.enable();
  bench.run_ms(static_cast<int>(2001 - bench.ms));
  EXPECT_TRUE(bench.devices.drives()[4].released);
  bench.received.clear();
  bench.run_ms(200);
  bool booted = false;
  for (const BusRecord& r : bench.received) booted = booted || (r.frame.id == 0x705 && r.frame.data[0] == 0);
  EXPECT_TRUE(booted);
}

TEST(Devices, a_dropped_identifier_is_missing_to_its_receivers) {
  Bench bench(with_fault(DeviceFaultKind::drop_frames, 0, 0.1, 0x183));
  bench.enable();
  bench.run_ms(static_cast<int>(2004 - bench.ms));
  bench.ids.clear();
  bench.run_ms(90);
  EXPECT_EQ(bench.ids[0x183], 0);
  EXPECT_GT(bench.ids[0x182], 20);
  bench.run_ms(50);
  EXPECT_GT(bench.ids[0x183], 5);
}

TEST(Devices, the_masters_own_bus_off_is_told_and_ends) {
  Bench bench(with_fault(DeviceFaultKind::bus_off, can_map::master_node, 0.05));
  bench.enable();
  bench.run_ms(static_cast<int>(1999 - bench.ms));
  bench.received.clear();
  bench.run_ms(40);
  ASSERT_FALSE(bench.received.empty());
  EXPECT_EQ(bench.received.back().frame.id, CanFrame::error_flag | 0x40u);
  EXPECT_FALSE(bench.devices.master_sends({}, bench.now));
  bench.run_ms(20);
  bool restarted = false;
  for (const BusRecord& r : bench.received) restarted = restarted || r.frame.id == (CanFrame::error_flag | 0x100u);
  EXPECT_TRUE(restarted);
}

TEST(Devices, a_node_that_was_off_the_bus_reports_8140) {
  Bench bench(with_fault(DeviceFaultKind::bus_off, 1, 0.05));
  bench.enable();
  bench.run_ms(static_cast<int>(2100 - bench.ms));
  bool told = false;
  for (const BusRecord& r : bench.received) told = told || (r.frame.id == 0x81 && (r.frame.data[0] | (r.frame.data[1] << 8)) == 0x8140);
  EXPECT_TRUE(told);
}

TEST(Devices, error_frames_cost_time_and_lose_nothing) {
  Bench bench(with_fault(DeviceFaultKind::error_frames, 0));
  bench.enable();
  bench.run_ms(static_cast<int>(2004 - bench.ms));
  bench.ids.clear();
  bench.run_ms(400);
  for (std::uint32_t id = 0x181; id <= 0x186; ++id) EXPECT_EQ(bench.ids[id], 100) << id;
  EXPECT_GT(bench.devices.bus().errors, 50u);
}

TEST(Devices, safety_inputs_open_by_fault_and_by_hand) {
  DevicesConfig config = with_fault(DeviceFaultKind::estop, 0, 0.1);
  config.faults.push_back({2.0, DeviceFaultKind::interlock_open, 0, 0.1, 0});
  Bench bench(config);
  bench.enable();
  const auto inputs = [&] {
    int value = -1;
    for (const BusRecord& r : bench.received) {
      if (r.frame.id == 0x186) value = r.frame.data[0];
    }
    return value;
  };
  bench.run_ms(static_cast<int>(1990 - bench.ms));
  EXPECT_EQ(inputs(), 3);
  bench.run_ms(50);
  EXPECT_EQ(inputs(), 0);
  bench.run_ms(150);
  EXPECT_EQ(inputs(), 3);
  bench.devices.set_estop_closed(false);
  bench.run_ms(10);
  EXPECT_EQ(inputs(), can_map::input_interlock_closed);
}

TEST(Devices, a_dead_master_stops_every_drive_within_310_ms) {
  Bench bench;
  bench.enable();
  bench.output = can_map::output_laser;
  bench.run_ms(200);
  ASSERT_TRUE(bench.devices.laser_on());
  while (bench.ms % 100 != 1) bench.step();  // just after a heartbeat
  bench.cyclic = bench.beats = false;
  bench.run_ms(310);
  for (std::uint8_t node = 1; node <= 6; ++node) EXPECT_EQ(bench.emergency_of(node), 0x8130) << static_cast<int>(node);
  EXPECT_FALSE(bench.devices.laser_on());
}

TEST(Devices, equal_seeds_give_equal_traffic_and_other_seeds_do_not) {
  const auto traffic = [](std::uint64_t seed) {
    DevicesConfig config = bench_config();
    config.seed = seed;
    Bench bench(config);
    bench.enable();
    for (int i = 0; i < 100; ++i) {
      for (std::int32_t& t : bench.targets) ++t;
      bench.run_ms(4);
    }
    return std::move(bench.log);
  };
  const std::vector<BusRecord> a = traffic(5), b = traffic(5), c = traffic(6);
  const auto equal = [](const std::vector<BusRecord>& x, const std::vector<BusRecord>& y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const BusRecord& p, const BusRecord& q) {
      return p.frame == q.frame && p.delivered == q.delivered && p.sender == q.sender;
    });
  };
  EXPECT_TRUE(equal(a, b));
  EXPECT_FALSE(equal(a, c));
}

// Frames at the nodes' own identifiers, so that they get deep, with the times of a busy bus.
TEST(Devices, a_hundred_thousand_random_frames_break_nothing) {
  Bench bench;
  bench.run_ms(200);
  std::mt19937_64 random(20261121);
  SCOPED_TRACE("seed 20261121");
  const std::uint32_t bases[] = {0x000, 0x080, 0x200, 0x300, 0x400, 0x500, 0x600, 0x600, 0x600, 0x77F};
  const std::uint16_t indexes[] = {0x1000, 0x1003, 0x1005, 0x1010, 0x1016, 0x1017, 0x1400, 0x1600, 0x1800, 0x1A00, 0x1A03, 0x2000, 0x6040,
                                   0x605A, 0x6060, 0x6065, 0x6072, 0x607A, 0x607C, 0x607D, 0x6098, 0x60C2, 0x60FF, 0x6200, 0x2100};
  std::uint64_t sent = 0;
  while (sent < 100000) {
    for (int i = 0; i < 8; ++i, ++sent) {
      CanFrame f;
      const std::uint64_t r = random();
      const std::uint32_t base = bases[r % 10];
      f.id = base == 0 || base == 0x80 || base == 0x77F ? base : base + 1 + static_cast<std::uint32_t>((r >> 8) % 6);
      if ((r >> 16) % 50 == 0) f.id = static_cast<std::uint32_t>(r >> 32);
      f.length = static_cast<std::uint8_t>((r >> 24) % 5 == 0 ? (r >> 28) % 9 : 8);
      for (std::size_t k = 0; k < f.length; ++k) f.data[k] = static_cast<std::uint8_t>(random());
      if (base == 0 && f.length == 2) f.data[1] = static_cast<std::uint8_t>(f.data[1] % 8);
      if (base == 0x600) {
        f.data[0] = static_cast<std::uint8_t>(random() % 4 == 0 ? f.data[0] : (random() % 2 == 0 ? 0x40 : 0x23 | ((random() % 4) << 2)));
        const std::uint16_t index = indexes[random() % std::size(indexes)];
        f.data[1] = static_cast<std::uint8_t>(index & 0xFF);
        f.data[2] = static_cast<std::uint8_t>(index >> 8);
        f.data[3] = static_cast<std::uint8_t>(f.data[3] % 4);
      }
      bench.devices.master_sends(f, bench.now);
    }
    bench.step();
    for (const JointDrive& d : bench.devices.drives()) {
      ASSERT_TRUE(std::isfinite(d.velocity_rad_s) && std::isfinite(d.torque_limit_nm) && d.torque_limit_nm >= 0) << "after " << sent;
    }
    bench.log.clear();
    bench.received.clear();
  }
}

TEST(Devices, impossible_figures_are_refused) {
  const auto refused = [](auto change) {
    DevicesConfig config = bench_config();
    change(config);
    EXPECT_THROW(Devices{config}, InputError);
  };
  refused([](DevicesConfig& c) { c.drives[1].node = 1; });
  refused([](DevicesConfig& c) { c.drives[1].node = 0; });
  refused([](DevicesConfig& c) { c.drives[1].rated_torque_nm = 0; });
  refused([](DevicesConfig& c) { c.drives[1].peak_torque_nm = std::nan(""); });
  refused([](DevicesConfig& c) { c.drives[1].upper_rad = c.drives[1].lower_rad; });
  refused([](DevicesConfig& c) { c.drives[1].actuator.offset_rad = 3.0; });
  refused([](DevicesConfig& c) { c.drives[1].stiction_rad_s = 100; });
  refused([](DevicesConfig& c) { c.faults.push_back({1, DeviceFaultKind::hot, 6, 0, 0}); });
  refused([](DevicesConfig& c) { c.faults.push_back({1, DeviceFaultKind::silent, 9, 0, 0}); });
  refused([](DevicesConfig& c) { c.faults.push_back({-1, DeviceFaultKind::estop, 0, 0, 0}); });
}

}  // namespace
}  // namespace lf::devices::test
