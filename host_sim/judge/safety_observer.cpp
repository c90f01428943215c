#include "host_sim/judge/safety_observer.hpp"

#include <algorithm>
#include <cmath>

#include "shared/can/can_map.hpp"

namespace lf::judge {

namespace {

// CiA 301's pre-defined connection set.
constexpr std::uint32_t emergency = 0x080, first_tpdo = 0x180, first_rpdo = 0x200, heartbeat = 0x700, function_mask = 0x780,
                        node_mask = 0x7F;
constexpr std::uint8_t boot_up = 0;
constexpr float moves_rad_s = 0.02f;
// CiA 402: the statusword's fault bit; a controlword of "enable operation" has its four low bits set.
// The master maps 6040, of two bytes, and 607A into the first RPDO.
constexpr std::size_t target_byte = 2;
constexpr std::uint8_t status_fault = 0x08, run_bits = 0x0F;

}  // namespace

void SafetyObserver::begin(const devices::Devices& devices, Time now) {
  devices_ = &devices;
  begin_ = now;
  seen_ = {};
  seen_.arm_joints = drive_count() - 1;
}

void SafetyObserver::on_bus_frame(const devices::BusRecord& record) {
  const CanFrame& frame = record.frame;
  const std::optional<std::size_t> index = index_of(frame.id & node_mask);
  const bool of_drive = index && *index < drive_count();
  const bool from_master = record.sender == can_map::master_node;
  if (from_master && (frame.id & function_mask) == first_rpdo && of_drive) {
    run_ordered_[*index] = (frame.data[0] & run_bits) == run_bits;
    if (devices_ != nullptr && record.delivered >= begin_ && run_ordered_[*index]) note_target(*index, frame);
  }
  if (devices_ == nullptr || record.delivered < begin_) return;
  const double t_s = (record.delivered - begin_).s();
  if (record.sender == devices::second_master) {
    if (!seen_.second_master_s) seen_.second_master_s = t_s;
    return;
  }
  if (from_master) return;
  judge_report(frame, t_s);
  if ((frame.id & function_mask) == first_tpdo && index) seen_.last_heard_s[*index] = t_s;
}

std::optional<std::size_t> SafetyObserver::index_of(std::size_t node) const {
  const auto found = std::find(nodes_.begin(), nodes_.end(), node);
  return found == nodes_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - nodes_.begin()));
}

void SafetyObserver::note_target(std::size_t joint, const CanFrame& frame) {
  std::uint32_t raw = 0;
  for (std::size_t byte = 0; byte < 4; ++byte) raw |= std::uint32_t{frame.data[target_byte + byte]} << (8 * byte);
  const auto target = static_cast<std::int32_t>(raw);
  auto& span = seen_.told_to_go[joint];
  span = span ? std::pair(std::min(span->first, target), std::max(span->second, target)) : std::pair(target, target);
}

void SafetyObserver::judge_report(const CanFrame& frame, double t_s) {
  const std::uint32_t function = frame.id & function_mask;
  const std::size_t node = frame.id & node_mask;
  const std::optional<std::size_t> index = index_of(node);
  const bool of_drive = index && *index < drive_count(), of_io = index && *index == drive_count();
  const bool fault = function == first_tpdo && of_drive && (frame.data[0] & status_fault) != 0;
  const bool emcy = function == emergency && node != 0 && (frame.data[0] != 0 || frame.data[1] != 0);
  const bool rebooted = function == heartbeat && frame.data[0] == boot_up;
  const bool chain_open = function == first_tpdo && of_io && (frame.data[0] & can_map::input_estop_closed) == 0;
  if ((fault || emcy || rebooted || chain_open) && !seen_.fault_reported_s) seen_.fault_reported_s = t_s;
  if (fault && !seen_.drive_fault_s) seen_.drive_fault_s = t_s;
  if (chain_open && !seen_.chain_open_s) seen_.chain_open_s = t_s;
}

void SafetyObserver::on_step(Time, const world::World& world) {
  if (devices_ == nullptr) return;
  Moment moment;
  const JointReadings readings = world.readings();
  for (std::size_t i = 0; i < drive_count(); ++i) {
    moment.speed_rad_s[i] = static_cast<float>(std::abs(readings[i].velocity_rad_s));
    moment.angle_rad[i] = static_cast<float>(readings[i].position_rad);
    moment.motor_rad[i] = static_cast<float>(readings[i].motor_position_rad);
    if (i + 1 < drive_count() && moment.speed_rad_s[i] >= moves_rad_s)
      moment.works_nm[i] = static_cast<float>(std::copysign(1.0, readings[i].velocity_rad_s) * readings[i].torque_nm);
    const devices::DrivePower power = devices_->power(i);
    const auto bit = static_cast<JointBits>(1u << i);
    if (power != devices::DrivePower::off) moment.power |= bit;
    if (power == devices::DrivePower::operation && run_ordered_[i]) moment.told_to_run |= bit;
  }
  const world::ContactReport contacts = world.contacts();
  moment.force_n = static_cast<float>(contacts.largest_force_n);
  moment.push_n = static_cast<float>(contacts.obstacle_force_n);
  moment.grip_n = static_cast<float>(contacts.grip_force_n);
  seen_.moments.push_back(moment);
}

}  // namespace lf::judge
