// The operator's side of a commissioning: prepares it, lends it to the control thread, writes what it found into the homing file, and gives the core its
// new zeros. One at a time.
//
// Files and memory are a worker's business: nothing here blocks. One thread owns it, the one that serves the socket.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "hal/vehicle/control_loop.hpp"
#include "hal/vehicle/findings.hpp"
#include "hal/vehicle/homing_changes.hpp"
#include "hal/vehicle/parse_order.hpp"
#include "hal/vehicle/status_json.hpp"
#include "hal/vehicle/vehicle_config.hpp"
#include "hal/vehicle/worker.hpp"
#include "hal/vehicle/zero_moved.hpp"

namespace lf::hal {

class Commissioner {
 public:
  using Log = std::function<void(const Json&)>;

  Commissioner(const VehicleConfig& config, LoopRings& rings, Log log);
  ~Commissioner();
  Commissioner(const Commissioner&) = delete;
  Commissioner& operator=(const Commissioner&) = delete;

  // Why it cannot begin, in words; nothing: answer() tells later whether it has.
  // `ordered`: when it came from the operator.
  std::optional<std::string> begin(const CommissionOrder& order, Time ordered);
  // One that has not begun will not: another order to the core came, or who ordered it has gone. One that moves by then goes on; an `abort` stops it as an order.
  // True when this is the first of these calls while one may still be before its begin.
  bool call_off_before_it_moves(const std::string& why);
  // {"ok": ...} once after each begin(), when the control thread has begun it or when it could not.
  std::optional<Json> answer();
  // From begin() until the new zeros are on the disk and in the core.
  bool busy() const { return stage_ != Stage::idle; }
  // Why an order that asks for power is refused meanwhile, in words; nothing when none is under way.
  std::optional<std::string> why_no_power() const;
  // One look at what has come back.
  void step();

  // What the control loop says of the core at work: whether it doubts what its jaw holds, and the joints whose drive has lost its position. They need a zero
  // until they are commissioned, by the file, too. A report of the core before is not heard.
  void hear(const ControlReport& report);
  // Joints that take no power since their zero is not known: "slew, elbow"; empty when there is none.
  std::string unknown_joints() const;
  // How the last one ended, once the core has what it found; null before the first.
  Json last() const { return last_; }

 private:
  // What a worker leaves; guarded by its mutex.
  struct Prepared {
    std::mutex mutex;
    bool done = false;
    std::string problem;
    TakenOver taken;
    std::unique_ptr<Commissioning> commissioning;
    std::unique_ptr<Controller> core;
    config::HomingOffsets offsets;
    Marks marks;
    JointSet found{};
  };
  // The joints whose zeros a worker takes out of the file; `done` and `problem` are guarded.
  struct Forgetting {
    JointSet joints{};
    std::mutex mutex;
    bool done = false;
    std::string problem;
  };
  enum class Stage { idle, preparing, lending, running, storing, installing };

  void lose_zeros(const JointSet& lost);
  std::string disown(const std::string& why);
  std::string old_zero_stays() const;
  void not_begun();
  void forget_in_file(const JointSet& lost);
  void drop_late();
  void note_forgotten();
  void lend();
  void take_back(const CommissioningResult& result);
  Commissioned findings_of(const Commissioning& ended) const;
  void store(const Commissioning& ended, const std::string& failed);
  static void give(Prepared& prepared, const std::string& problem, const TakenOver& taken, const config::HomingOffsets& offsets,
                   std::unique_ptr<Controller> core);
  void install();
  // The outcome is logged at once, and is last()'s when the control thread has taken the core over.
  void give_core(std::unique_ptr<Controller> core, const Json& outcome);
  void end_with(const Json& outcome);
  void write_down(const Json& outcome) const;  // in the log

  ControllerConfig core_;
  JointSet zero_lost_{};   // of the core at work
  JointSet still_lost_{};  // those of them that the commissioning under way has not found
  JointSet disowned_{};    // called wrong by an order that was called off before it moved: without power until they are found
  JointSet forgotten_{};   // those that the file has no more
  Time try_again_;         // when the file could not be written; 0: it could
  JointSet last_tried_{};  // a failure is told once for the same joints
  bool jaw_doubted_ = false;
  std::uint32_t cores_taken_ = 0;  // by the control loop
  std::uint32_t ended_ = 0;        // commissionings that had begun
  bool without_power_ = true;      // after the last one
  std::shared_ptr<Forgetting> forgetting_;
  std::string file_;
  bool file_is_shipped_ = false;
  JointNames names_;
  PerJoint<double> backlash_rad_{};
  PerJoint<Motor> motors_;
  LoopRings& rings_;
  Log log_;
  Stage stage_ = Stage::idle;
  CommissionOrder order_;
  Time ordered_, lent_;
  std::string called_off_;  // why it shall not begin, unless it has; empty: it shall
  std::shared_ptr<Prepared> prepared_;
  std::unique_ptr<Commissioning> commissioning_;  // lent while it runs
  Marks marks_;                                   // in the file, meanwhile
  std::unique_ptr<Controller> core_given_;        // until the control thread has taken it
  Json outcome_;                                  // meanwhile
  std::optional<Json> answer_;
  Json last_;
  Worker worker_{"commission"};
};

}  // namespace lf::hal
