#include "host_sim/app/dbc.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "shared/can/can_map.hpp"

namespace lf::app {
namespace {

constexpr const char* master = "master";

using Names = std::vector<std::pair<int, const char*>>;
const Names nmt_commands{{1, "start"}, {2, "stop"}, {128, "enter_pre_operational"}, {129, "reset_node"}, {130, "reset_communication"}};
const Names nmt_states{{0, "boot_up"}, {4, "stopped"}, {5, "operational"}, {127, "pre_operational"}};

// The shortest text that is this very number.
std::string text_of(double value) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

struct Signal {
  std::string name;
  std::size_t start_bit = 0, bits = 0;
  bool is_signed = false;
  double factor = 1;
  std::string unit{}, receiver{"Vector__XXX"}, comment{};
  const Names* values = nullptr;
};

struct Message {
  std::uint32_t id = 0;
  std::string name;
  std::size_t length = 0;
  std::string sender;
  std::int64_t cycle_ms = 0;
  std::vector<Signal> signals;
};

std::string line_of(const Signal& s) {
  const double low = s.is_signed ? -static_cast<double>(1LL << (s.bits - 1)) : 0;
  const double high = s.is_signed ? static_cast<double>((1LL << (s.bits - 1)) - 1) : static_cast<double>((1LL << s.bits) - 1);
  // A scale that counts backwards turns the range round.
  const double least = std::min(low * s.factor, high * s.factor), most = std::max(low * s.factor, high * s.factor);
  return " SG_ " + s.name + " : " + std::to_string(s.start_bit) + "|" + std::to_string(s.bits) + "@1" + (s.is_signed ? "-" : "+") + " (" +
         text_of(s.factor) + ",0) [" + text_of(least) + "|" + text_of(most) + "] \"" + s.unit + "\" " + s.receiver + "\n";
}

std::int64_t ms(Duration d) { return d.ns() / 1'000'000; }

Message heartbeat(std::uint8_t node, const std::string& name, Duration every) {
  return {0x700u + node, name + "_heartbeat", 1, name, ms(every), {{.name = "state", .start_bit = 0, .bits = 8, .values = &nmt_states}}};
}

Signal position_of(const DbcDrive& drive, const char* name, std::size_t byte, const std::string& receiver) {
  return {.name = name,
          .start_bit = 8 * byte,
          .bits = 32,
          .is_signed = true,
          .factor = drive.position,
          .unit = drive.screw ? "m" : "rad",
          .receiver = receiver,
          .comment = std::string(drive.screw ? "Growth of the joint's screw" : "Joint angle") + " since the drive's own zero."};
}

Signal torque_of(const DbcDrive& drive, const char* name, std::size_t byte, const std::string& receiver) {
  return {.name = name,
          .start_bit = 8 * byte,
          .bits = 16,
          .is_signed = true,
          .factor = drive.torque_nm,
          .unit = "N m",
          .receiver = receiver,
          .comment = "At the motor's shaft."};
}

Message rpdo(const DbcDrive& drive) {
  using namespace can_map::drive_rpdo1;
  Message message{0x200u + drive.node, drive.name + "_rpdo1", length, master, ms(can_map::sync_period), {}};
  message.signals = {{.name = "controlword", .start_bit = 8 * controlword, .bits = 16, .receiver = drive.name},
                     position_of(drive, "target_position", target_position, drive.name)};
  if (drive.torque_offset)
    message.signals.push_back(torque_of(drive, "torque_offset", torque_offset, drive.name));
  else
    message.length = torque_offset;
  return message;
}

Message tpdo(const DbcDrive& drive) {
  using namespace can_map::drive_tpdo1;
  return {0x180u + drive.node,
          drive.name + "_tpdo1",
          length,
          drive.name,
          ms(can_map::sync_period),
          {{.name = "statusword", .start_bit = 8 * statusword, .bits = 16, .receiver = master},
           position_of(drive, "position", position, master),
           torque_of(drive, "torque", torque, master)}};
}

// Which bit of a byte is set.
constexpr std::size_t bit_of(std::uint8_t mask) {
  std::size_t bit = 0;
  while ((mask >> bit & 1) == 0) ++bit;
  return bit;
}

std::vector<Message> process_data_of_outputs(std::uint8_t node, const std::string& name) {
  using namespace can_map;
  const auto bit = [](std::string signal, std::size_t byte, std::uint8_t mask, const std::string& receiver) {
    return Signal{.name = std::move(signal), .start_bit = 8 * byte + bit_of(mask), .bits = 1, .receiver = receiver};
  };
  const auto number = [](std::string signal, std::size_t byte, std::size_t bits, const std::string& receiver, const char* unit) {
    return Signal{.name = std::move(signal), .start_bit = 8 * byte, .bits = bits, .unit = unit, .receiver = receiver};
  };
  return {{0x200u + node,
           name + "_rpdo1",
           io_rpdo1::length,
           master,
           ms(sync_period),
           {bit("laser", io_rpdo1::outputs, output_laser, name), bit("lamps", io_rpdo1::outputs, output_lamps, name),
            number("trigger_counter", io_rpdo1::trigger_counter, 8, name, ""), number("exposure", io_rpdo1::exposure, 16, name, "us")}},
          {0x180u + node,
           name + "_tpdo1",
           io_tpdo1::length,
           name,
           ms(sync_period),
           {bit("estop_closed", io_tpdo1::inputs, input_estop_closed, master),
            bit("interlock_closed", io_tpdo1::inputs, input_interlock_closed, master),
            bit("laser_actual", io_tpdo1::outputs_actual, output_laser, master),
            bit("lamps_actual", io_tpdo1::outputs_actual, output_lamps, master),
            number("last_trigger_counter", io_tpdo1::last_trigger_counter, 8, master, ""),
            number("last_exposure", io_tpdo1::last_exposure, 16, master, "us")}}};
}

void add_services(std::uint8_t node, const std::string& name, std::vector<Message>& all) {
  all.push_back({0x080u + node,
                 name + "_emcy",
                 8,
                 name,
                 0,
                 {{.name = "error_code", .start_bit = 0, .bits = 16, .comment = "CiA 301 and 402; 0 is the end of an error."},
                  {.name = "error_register", .start_bit = 16, .bits = 8},
                  {.name = "manufacturer", .start_bit = 24, .bits = 40}}});
  for (const bool answer : {true, false})
    all.push_back({(answer ? 0x580u : 0x600u) + node,
                   name + (answer ? "_sdo_answer" : "_sdo_request"),
                   8,
                   answer ? name : master,
                   0,
                   {{.name = "command", .start_bit = 0, .bits = 8},
                    {.name = "object_index", .start_bit = 8, .bits = 16},
                    {.name = "sub_index", .start_bit = 24, .bits = 8},
                    {.name = "data", .start_bit = 32, .bits = 32}}});
  all.push_back(heartbeat(node, name, can_map::node_heartbeat));
}

std::vector<Message> messages_of(const std::vector<DbcDrive>& drives, std::uint8_t outputs_node, const std::string& outputs) {
  std::vector<Message> all{{0x000,
                            "nmt",
                            2,
                            master,
                            0,
                            {{.name = "command", .start_bit = 0, .bits = 8, .values = &nmt_commands},
                             {.name = "node", .start_bit = 8, .bits = 8, .comment = "0 is all of them."}}},
                           {0x080, "sync", 0, master, ms(can_map::sync_period), {}},
                           heartbeat(can_map::master_node, master, can_map::master_heartbeat)};
  for (const DbcDrive& drive : drives) {
    all.push_back(rpdo(drive));
    all.push_back(tpdo(drive));
    add_services(drive.node, drive.name, all);
  }
  for (Message& message : process_data_of_outputs(outputs_node, outputs)) all.push_back(std::move(message));
  add_services(outputs_node, outputs, all);
  std::stable_sort(all.begin(), all.end(), [](const Message& a, const Message& b) { return a.id < b.id; });
  return all;
}

}  // namespace

std::string dbc(const std::vector<DbcDrive>& drives, std::uint8_t outputs_node) {
  // A joint may be called so, too.
  std::string outputs = "outputs";
  while (std::any_of(drives.begin(), drives.end(), [&](const DbcDrive& drive) { return drive.name == outputs; })) outputs += "_";
  const std::vector<Message> messages = messages_of(drives, outputs_node, outputs);
  std::string text = "VERSION \"1\"\n\nNS_ :\n\nBS_:\n\nBU_: " + std::string(master);
  for (const DbcDrive& drive : drives) text += " " + drive.name;
  text += " " + outputs + "\n\n";
  for (const Message& m : messages) {
    text += "BO_ " + std::to_string(m.id) + " " + m.name + ": " + std::to_string(m.length) + " " + m.sender + "\n";
    for (const Signal& s : m.signals) text += line_of(s);
    text += "\n";
  }
  for (const Message& m : messages) {
    for (const Signal& s : m.signals)
      if (!s.comment.empty()) text += "CM_ SG_ " + std::to_string(m.id) + " " + s.name + " \"" + s.comment + "\";\n";
  }
  text += "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\nBA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n";
  for (const Message& m : messages)
    if (m.cycle_ms > 0) text += "BA_ \"GenMsgCycleTime\" BO_ " + std::to_string(m.id) + " " + std::to_string(m.cycle_ms) + ";\n";
  for (const Message& m : messages) {
    for (const Signal& s : m.signals) {
      if (s.values == nullptr) continue;
      text += "VAL_ " + std::to_string(m.id) + " " + s.name;
      for (const auto& [number, name] : *s.values) text += " " + std::to_string(number) + " \"" + name + "\"";
      text += " ;\n";
    }
  }
  return text;
}

}  // namespace lf::app
