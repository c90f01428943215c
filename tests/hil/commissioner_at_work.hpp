// A commissioner as the daemon has it, with a homing file of its own.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <functional>
#include <memory>
#include <string>

#include "hal/vehicle/commissioner.hpp"
#include "hal/vehicle/tick_clock.hpp"
#include "tests/arm5e_joint_names.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/hil/commissioning_bench.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::test {

inline constexpr PerJoint<bool> only_jaw{false, false, false, false, true};

// The test plays the control thread.
class AtWork {
 public:
  explicit AtWork(std::int32_t jaw_zero_counts) {
    write_homing("jaw: {zero_counts: " + std::to_string(jaw_zero_counts) + "}\n");
    start();
  }
  // The arm's joints have the simulated drives' zeros.
  void write_homing(const std::string& jaw) {
    std::string text;
    for (std::size_t i = 0; i < arm5e_joint::of_arm; ++i)
      text += std::string(arm5e_joint::name(i)) + ": {zero_counts: " + std::to_string(somewhere[i]) + "}\n";
    folder.write("homing.yaml", text + jaw);
  }
  // As the daemon, anew.
  void start() {
    const hal::VehicleConfig vehicle = hal::load_vehicle_config(
        folder.write("vehicle.yaml", "can: {interface: can0}\ncamera: {source: none}\nlock_folder: " + folder.path().string() +
                                         "\nlog: {folder: " + (folder / "log") + "}\nhoming: {file: homing.yaml}\n"));
    commissioner = std::make_unique<hal::Commissioner>(vehicle, *rings, [](const hal::Json&) {});
  }
  bool wait_for(const std::function<bool()>& done) {
    for (int ms = 0; ms < 20'000 && !done(); ++ms) {
      commissioner->step();
      usleep(1000);
    }
    return done();
  }
  // Lent by the commissioner; null where it is not.
  hal::Commissioning* begin(const PerJoint<bool>& joints, bool moved = false) {
    hal::CommissionOrder order;
    order.joints = joints;
    order.moved = moved;
    (void)commissioner->answer();  // of the one before
    EXPECT_EQ(commissioner->begin(order, hal::monotonic_now()), std::nullopt);
    hal::CommissioningLoan loan;
    EXPECT_TRUE(wait_for([&] { return loan.commissioning != nullptr || rings->commissionings.pop(loan); }));
    return loan.commissioning;
  }
  // To its good end, and the new core has taken over.
  void commission_jaw() {
    CommissioningBench bench(somewhere);
    hal::Commissioning* lent = begin(only_jaw);
    ASSERT_NE(lent, nullptr);
    bench.run(*lent);
    EXPECT_EQ(lent->state(), hal::Commissioning::State::done) << lent->failure();
    EXPECT_NE(end(lent), nullptr);
    ASSERT_TRUE(take_over());
  }
  // The core with what it found, or was left of it.
  std::unique_ptr<Controller> end(hal::Commissioning* lent) {
    EXPECT_TRUE(rings->commissioned.push({lent, true}));
    Controller* core = nullptr;
    EXPECT_TRUE(wait_for([&] { return core != nullptr || rings->cores.pop(core); }));
    return std::unique_ptr<Controller>(core);
  }
  // As the control loop does when it has taken the core over.
  bool take_over() {
    rings->old_cores.push(nullptr);
    return wait_for([&] { return !commissioner->busy(); });
  }

  config::HomingOffsets file() const { return config::read_homing_file(folder / "homing.yaml", {}); }
  std::string why() const { return commissioner->last()["why"]; }

  const TemporaryFolder folder;
  const std::unique_ptr<hal::LoopRings> rings = std::make_unique<hal::LoopRings>();
  std::unique_ptr<hal::Commissioner> commissioner;
};

}  // namespace lf::test
