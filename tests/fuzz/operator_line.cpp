// A line of an operator: whatever its bytes are, a request within its ranges or one line of valid UTF-8 that says what is wrong.
#include <cmath>
#include <nlohmann/json.hpp>

#include "hal/vehicle/order_desk.hpp"
#include "hal/vehicle/parse_order.hpp"
#include "tests/arm5e_joints.hpp"
#include "tests/fuzz/input.hpp"

namespace lf::fuzz {
namespace {

constexpr std::size_t longest_answer = 400;  // bytes: 200 letters, none of them longer than two in a message of ours

void check_refusal(const std::string& why) {
  expect(!why.empty() && why.size() <= longest_answer, "a refusal is a sentence");
  expect(why.find('\n') == std::string::npos, "a refusal is one line");
  (void)nlohmann::json(why).dump();  // throws for what is not UTF-8
}

void check_request(const hal::OperatorRequest& request) {
  expect(request.right != nullptr, "a request has its row");
  expect(std::isfinite(request.order.by_rad) && std::abs(request.order.by_rad) <= mission::largest_jog_rad, "a jog is within its range");
  expect(static_cast<std::size_t>(request.order.joint) < arm5e_joint::count, "a joint is one of the arm's");
  for (const auto& task : request.order.tasks) expect(std::abs(task.to_rad) <= 3.2 && task.button < 3, "a task is within its range");
}

}  // namespace
}  // namespace lf::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view line(reinterpret_cast<const char*>(data), size);
  const lf::hal::ParsedOrder parsed = lf::hal::parse_order(line);
  if (const auto* why = std::get_if<std::string>(&parsed)) lf::fuzz::check_refusal(*why);
  if (const auto* request = std::get_if<lf::hal::OperatorRequest>(&parsed)) lf::fuzz::check_request(*request);
  // What overtakes other lines has to be the order itself, and nothing that only looks like it.
  const auto* request = std::get_if<lf::hal::OperatorRequest>(&parsed);
  if (lf::hal::OrderDesk::is_stop(line) && request != nullptr) {
    lf::fuzz::expect(request->order.command == lf::Command::emergency_stop, "a line that overtakes is a stop");
  }
  return 0;
}
