#include "hal/config/boot_sentence.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "firmware/canopen/sdo_abort.hpp"
#include "hal/config/drive_kind.hpp"

namespace lf::config {

namespace {

using canopen::BootFailure;

struct Remedy {
  std::uint16_t index;
  const char* text;
};

constexpr const char* no_cyclic_mode =
    "The master commands a position at each SYNC: use a drive that has cyclic synchronous position (mode 8)";

constexpr std::uint32_t first_value_abort = 0x06090030, last_value_abort = 0x06090032;  // CiA 301: out of range, too high, too low

constexpr std::array<Remedy, 20> remedies{{
    {0x1000, "Look whether the node number is right: the device there is no servo drive (CiA 402), or no output node (CiA 401)"},
    {0x1018, "Look whether the node number is right, and name this drive's profile in 'drives.<joint>.profile'"},
    {0x1016, "Without it the drive runs on when the master dies: its profile has to name node_guarding, if the drive has 100C and 100D"},
    {0x6007, "Its profile has to say what the drive does when the master is gone ('absent', fixed_by_maker), after that was tried"},
    {0x605A,
     "The master has to know what a quick stop does: use a drive that has it, or state its fixed behaviour in the profile ('absent', "
     "fixed_by_maker)"},
    {0x6060, no_cyclic_mode},
    {0x60C2, no_cyclic_mode},
    {0x6065, "The drive has to stop itself when it does not follow: use a drive that has it"},
    {0x6066, "Its profile may name master_times_following, or state 'options.following_timeout_ms' as the drive takes it"},
    {0x6072, "Its profile may name vendor_limit, when the torque is limited with the maker's tool"},
    {0x6076,
     "State 'drives.<joint>.rated_torque_nm', with a profile whose 'torque.rating' is configured, or commission the drive's motor data"},
    {0x6077, "Contact and grip are felt by it: use a drive that maps it"},
    {0x607C, "Its profile may name the drive's own object (other_object)"},
    {0x607D, "Its profile may name master_limits_position"},
    {0x607F, "Its profile may name master_limits_speed"},
    {0x6085, "Its profile may name fixed_by_maker, when the ramp is set with the maker's tool"},
    {0x6098, "The drive does not home itself: give it an absolute encoder"},
    {0x60A8, "Set the drive's position unit to what its profile says, or state the drive's own unit in a profile like it"},
    {0x60A9, "Set the drive's velocity unit to what its profile says, or state the drive's own unit in a profile like it"},
    {0x60B2, "Its profile may name no_feed_forward"},
}};

// A drive that has the object, and not this value of it.
constexpr std::array<Remedy, 2> value_remedies{{
    {0x6007, "State in the profile which value the drive takes: 'options.abort', or 'options.abort_fallback'"},
    {0x605A, "State in the profile which value the drive takes: 'options.quick_stop', or 'options.quick_stop_fallback'"},
}};

std::string remedy(std::uint16_t index, std::uint32_t abort_code = 0) {
  if (abort_code >= first_value_abort && abort_code <= last_value_abort) {
    const auto value = std::find_if(value_remedies.begin(), value_remedies.end(), [index](const Remedy& r) { return r.index == index; });
    if (value != value_remedies.end()) return value->text;
  }
  const auto found = std::find_if(remedies.begin(), remedies.end(), [index](const Remedy& r) { return r.index == index; });
  if (found != remedies.end()) return found->text;
  return "Set it with the maker's tool, or state what the drive has in a profile of its own";
}

bool is_map(std::uint16_t index) { return index == 0x1600 || index == 0x1A00; }

std::string hex(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "%08X", value);
  return text;
}

// 1018 is hex in profiles and in makers' documents.
std::string value_text(std::uint16_t index, std::uint32_t value) { return index == 0x1018 ? "0x" + hex(value) : std::to_string(value); }

std::string named(std::uint16_t index, std::uint8_t sub) {
  const std::string name = object_name(index);
  return object_text(index, sub) + (name.empty() ? "" : " " + name);
}

std::string what_happened(const canopen::NodeBoot& boot, const std::string& object) {
  const std::string numbers =
      " (holds " + value_text(boot.index, boot.read) + ", has to hold " + value_text(boot.index, boot.expected) + ")";
  const bool absent = boot.abort_code == canopen::sdo_abort::no_object || boot.abort_code == canopen::sdo_abort::no_sub_index;
  switch (boot.failure) {
    case BootFailure::sdo_aborted:
      if (absent) return object + " does not exist (" + hex(boot.abort_code) + ")";
      return object + ": " + canopen::sdo_abort::name(boot.abort_code) + " (" + hex(boot.abort_code) + ")" +
             (boot.expected != 0 ? numbers : "");
    case BootFailure::read_only: return object + " cannot be written" + numbers;
    case BootFailure::no_rating: return object + " is 0";
    case BootFailure::other_motor:
      return object + " is " + std::to_string(boot.read) + ", and " + std::to_string(boot.expected) +
             " by the arm's description: another motor, or another unit";
    case BootFailure::wrong_identity:
    case BootFailure::wrong_setting:
    case BootFailure::wrong_rating:
    case BootFailure::wrong_readback: return object + " has another value" + numbers;
    default: return (boot.index != 0 ? object + ": " : "") + canopen::name(boot.failure);
  }
}

}  // namespace

std::string boot_sentence(const canopen::NodeBoot& boot, const std::string& who) {
  if (boot.failure == BootFailure::none) return "";
  const std::string head = who + " (node " + std::to_string(boot.node) + "): ";
  // A refused mapping is about the object that was to be mapped.
  const bool mapping = is_map(boot.index) && boot.sub > 0 && boot.expected != 0;
  const auto index = mapping ? static_cast<std::uint16_t>(boot.expected >> 16) : boot.index;
  const auto sub = mapping ? static_cast<std::uint8_t>(boot.expected >> 8) : boot.sub;
  if (boot.index == 0) return head + canopen::name(boot.failure) + ". Look at its power, its cable and its node number";
  const std::string where = mapping ? " in " + named(boot.index, boot.sub) : "";
  if (mapping) return head + named(index, sub) + " cannot be mapped" + where + " (" + hex(boot.abort_code) + "). " + remedy(index);
  return head + what_happened(boot, named(index, sub)) + ". " + remedy(index, boot.abort_code);
}

std::string boot_sentences(const canopen::BootReport& report, const JointNames& names) {
  std::string all;
  for (std::size_t i = 0; i < report.nodes.size(); ++i) {
    const std::string one = boot_sentence(report.nodes[i], i < names.size() ? names[i] : "outputs");
    if (!one.empty()) all += "; " + one;
  }
  return all;
}

}  // namespace lf::config
