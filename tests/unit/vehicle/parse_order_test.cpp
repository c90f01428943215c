// Reading an operator's line: what is taken, what is said of the rest, and that no bytes do more than that.
#include "hal/vehicle/parse_order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "tests/arm5e_joints.hpp"

namespace lf::hal {
namespace {

using testing::HasSubstr;

std::string refusal(const std::string& line, const PanelNames& names = {}) {
  const ParsedOrder parsed = parse_order(line, names);
  const auto* why = std::get_if<std::string>(&parsed);
  return why != nullptr ? *why : "taken";
}

OperatorRequest taken(const std::string& line, const PanelNames& names = {}) {
  const ParsedOrder parsed = parse_order(line, names);
  const auto* request = std::get_if<OperatorRequest>(&parsed);
  if (request == nullptr) ADD_FAILURE() << line << ": " << std::get<std::string>(parsed);
  return request != nullptr ? *request : OperatorRequest{};
}

TEST(ParseOrder, TakesEveryRequestOfTheTable) {
  for (const Right& right : operator_rights()) EXPECT_EQ(taken(right.line).right, &right) << right.line;
  EXPECT_EQ(taken(R"({"do":"estop"})").order.command, Command::emergency_stop);
  EXPECT_FALSE(taken(R"({"do":"status"})").for_the_core);
}

TEST(ParseOrder, TakesAJog) {
  const OperatorRequest jog = taken(R"({"do":"jog","joint":"elbow","by_deg":-5})");
  EXPECT_TRUE(jog.for_the_core);
  EXPECT_EQ(jog.order.joint, arm5e_joint::elbow);
  EXPECT_NEAR(jog.order.by_rad, -5 * 3.14159265358979 / 180, 1e-12);
}

TEST(ParseOrder, TakesAJob) {
  const OperatorRequest job =
      taken(R"({"do":"task","tasks":[{"turn_valve":{"to_deg":-45.5}},{"press_buttons":{"order":["right","left"]}}]})");
  ASSERT_EQ(job.order.tasks.size(), 3u);
  EXPECT_NEAR(job.order.tasks[0].to_rad, -45.5 * 3.14159265358979 / 180, 1e-12);
  EXPECT_EQ(job.order.tasks[1].button, 2);
  EXPECT_EQ(job.order.tasks[2].button, 0);
}

const PanelNames two_valves{{"V1", "V2"}, {"B1", "B2"}, {"7"}};

TEST(ParseOrder, NamesTheValvesAndButtonsOfAFilesPanel) {
  const OperatorRequest job = taken(
      R"({"do":"task","tasks":[{"turn_valve":{"valve":"V2","to_deg":45}},{"press_buttons":{"order":["B2","B1"]}},{"turn_valve":{"to_deg":0,"valve":"V1"}}]})",
      two_valves);
  ASSERT_EQ(job.order.tasks.size(), 4u);
  EXPECT_EQ(job.order.tasks[0].kind, mission::Task::Kind::turn_valve);
  EXPECT_EQ(job.order.tasks[0].valve, 1);
  EXPECT_NEAR(job.order.tasks[0].to_rad, 45 * 3.14159265358979 / 180, 1e-12);
  EXPECT_EQ(job.order.tasks[1].button, 1);
  EXPECT_EQ(job.order.tasks[2].button, 0);
  EXPECT_EQ(job.order.tasks[3].valve, 0);
}

TEST(ParseOrder, AValveIsNamedWhereThePanelHasSeveral) {
  const auto turn = [](const char* which, const PanelNames& names) {
    return refusal(R"({"do":"task","tasks":[{"turn_valve":{)" + std::string(which) + R"("to_deg":45}}]})", names);
  };
  EXPECT_EQ(turn("", two_valves), "\"valve\" is missing: the panel has V1 or V2");
  EXPECT_EQ(turn(R"("valve":"",)", two_valves), "\"valve\" is missing: the panel has V1 or V2");
  EXPECT_EQ(turn(R"("valve":"V3",)", two_valves), "no valve 'V3': V1 or V2");
  EXPECT_EQ(turn(R"("valve":"valve",)", two_valves), "no valve 'valve': V1 or V2");
  EXPECT_THAT(turn(R"("valve":2,)", two_valves), HasSubstr("{\"valve\": NAME} where the panel has several"));
  EXPECT_EQ(turn("", {{}, {"B1"}, {"7"}}), "\"valve\" is missing: the panel has none");
  EXPECT_EQ(turn("", {}), "taken") << "the only one";
  EXPECT_EQ(turn(R"("valve":"valve",)", {}), "taken");
  EXPECT_EQ(turn(R"("valve":"V1",)", {}), "no valve 'V1': valve");
}

TEST(ParseOrder, AButtonIsOneOfThePanels) {
  const auto press = [](const char* order, const PanelNames& names) {
    return refusal(R"({"do":"task","tasks":[{"press_buttons":{"order":)" + std::string(order) + "}}]}", names);
  };
  EXPECT_EQ(press(R"(["B1","left"])", two_valves), "no button 'left': B1 or B2");
  EXPECT_EQ(press(R"(["B1"])", {}), "no button 'B1': left, centre or right");
  EXPECT_EQ(press("[]", two_valves), "press_buttons takes {\"order\": [B1, B2]}, one or more of them");
}

TEST(ParseOrder, TakesACommissioning) {
  const OperatorRequest all = taken(R"({"do":"commission","clear":true})");
  EXPECT_FALSE(all.for_the_core);
  EXPECT_EQ(all.commission.joints, all_joints());
  EXPECT_EQ(taken(R"({"do":"commission","joints":["elbow"],"clear":true})").commission.joints,
            (PerJoint<bool>{false, false, true, false, false}));
  EXPECT_TRUE(taken(R"({"do":"commission","here":true})").commission.here);
  const OperatorRequest moved = taken(R"({"do":"commission","joints":["roll"],"clear":true,"moved":true})");
  EXPECT_TRUE(moved.commission.moved && moved.commission.joints[3]);
  EXPECT_FALSE(taken(R"({"do":"commission","clear":true,"moved":false})").commission.moved);
  EXPECT_TRUE(taken(R"({"do":"commission","joints":["roll"],"here":true,"moved":true})").commission.moved);
  for (const char* joints : {"", R"("joints":["slew","jaw"],)"})
    EXPECT_THAT(refusal(std::string(R"({"do":"commission",)") + joints + R"("clear":true,"moved":true})"),
                HasSubstr("commission this joint alone"));
  EXPECT_THAT(refusal(R"({"do":"commission","joints":["roll"],"clear":true,"moved":"yes"})"), HasSubstr("true or false"));
  EXPECT_THAT(refusal(R"({"do":"commission"})"), HasSubstr("clear its reach"));
  EXPECT_THAT(refusal(R"({"do":"commission","clear":1})"), HasSubstr("true or false"));
  EXPECT_THAT(refusal(R"({"do":"commission","clear":true,"joints":["knee"]})"), HasSubstr("no joint 'knee'"));
  EXPECT_THAT(refusal(R"({"do":"commission","clear":true,"joints":[]})"), HasSubstr("one or more"));
}

// The first line ended the daemon in mid-mission: the JSON library throws for a member of what is no object.
TEST(ParseOrder, SaysWhatIsWrong) {
  EXPECT_THAT(refusal(R"({"do":"task","tasks":[{"turn_valve":90}]})"), HasSubstr("turn_valve takes {\"to_deg\": DEGREES}"));
  EXPECT_THAT(refusal(R"({"do":"task","tasks":[{"press_buttons":["left"]}]})"), HasSubstr("press_buttons takes"));
  EXPECT_THAT(refusal(R"({"do":"task","tasks":[{"press_buttons":{"order":[]}}]})"), HasSubstr("one or more"));
  EXPECT_THAT(refusal(R"({"do":"task","tasks":[{"press_buttons":{"order":["top"]}}]})"), HasSubstr("no button 'top'"));
  EXPECT_THAT(refusal(R"({"do":"task","tasks":[{"turn_valve":{"to_deg":181}}]})"), HasSubstr("from -180 to 180"));
  EXPECT_THAT(refusal(R"({"do":"task","tasks":[{"turn_valve":{"to_deg":1,"by":2}}]})"), HasSubstr("takes no 'by'"));
  EXPECT_THAT(refusal(R"({"do":"task","tasks":[]})"), HasSubstr("nothing to do"));
  EXPECT_THAT(refusal(R"({"do":"task","tasks":7})"), HasSubstr("a list"));
  EXPECT_THAT(refusal(R"({"do":"jog","joint":"neck","by_deg":1})"), HasSubstr("no joint 'neck'"));
  EXPECT_THAT(refusal(R"({"do":"jog","joint":3,"by_deg":1})"), HasSubstr("jog takes"));
  EXPECT_THAT(refusal(R"({"do":"jog","joint":"slew","by_deg":20.1})"), HasSubstr("20 deg at most"));
  EXPECT_THAT(refusal(R"({"do":"jog","joint":"slew","by_deg":1e999})"), HasSubstr("a JSON object"));
  EXPECT_THAT(refusal(R"({"do":"start","in":3})"), HasSubstr("start takes no 'in'"));
  EXPECT_EQ(refusal(R"({"do":"start","in":3})"), "start takes no 'in': it takes nothing but \"do\"");
  EXPECT_EQ(refusal(R"({"do":"commission","joint":"elbw"})"),
            "commission takes no 'joint': it takes \"joints\", \"here\", \"clear\", \"moved\"");
  EXPECT_EQ(refusal(R"({"do":"strt"})"), "no request 'strt'; did you mean 'start'?");
  EXPECT_EQ(refusal(R"({"do":"format-disk"})"), "no request 'format-disk'");
  EXPECT_THAT(refusal(R"({"do":7})"), HasSubstr("a JSON object"));
  EXPECT_THAT(refusal("[1]"), HasSubstr("a JSON object"));
  EXPECT_THAT(refusal(""), HasSubstr("a JSON object"));
  EXPECT_THAT(refusal(std::string(16'000, '[')), HasSubstr("nested too deep"));
  EXPECT_THAT(refusal("\xff\xfe{\"do\":\"start\"}"), HasSubstr("a JSON object"));
}

TEST(ParseOrder, QuotesLongTextsInPart) {
  std::string name;
  for (int i = 0; i < 500; ++i) name += "\u00e4";
  const std::string why = refusal(R"({"do":")" + name + R"("})");
  EXPECT_LT(why.size(), 120u);
  EXPECT_NO_THROW((void)nlohmann::json(why).dump());  // no letter is cut in two
}

// Lines as operators write them, then spoilt: bytes changed, left out, doubled, exchanged for pieces of other lines.
class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string line() {
    std::string text = lines_[below(lines_.size())];
    for (std::size_t n = below(4); n > 0; --n) spoil(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }

  void spoil(std::string& text) {
    const std::size_t at = below(text.size() + 1), length = below(12);
    const std::string& other = lines_[below(lines_.size())];
    const std::string piece = other.substr(below(other.size()), length);
    switch (below(6)) {
      case 0: return void(text.insert(at, 1, static_cast<char>(below(256))));
      case 1: return void(text.erase(at, length));
      case 2: return void(text.insert(at, piece));
      case 3: return void(text.replace(at, length, piece));
      case 4: return void(text.replace(at, 1, values_[below(values_.size())]));
      default: return replace_value(text);
    }
  }

  // A value of another kind where one stood: what a type error needs.
  void replace_value(std::string& text) {
    const std::size_t colon = text.find(':', below(text.size() + 1));
    if (colon == std::string::npos) return;
    const std::size_t end = text.find_first_of(",}]", colon);
    if (end != std::string::npos) text.replace(colon + 1, end - colon - 1, values_[below(values_.size())]);
  }

  std::mt19937 random_;
  std::array<std::string, 9> lines_{R"({"do":"status"})",
                                    R"({"do":"estop"})",
                                    R"({"do":"start"})",
                                    R"({"do":"jog","joint":"elbow","by_deg":-5})",
                                    R"({"do":"jog","joint":"jaw","by_deg":1.5e1})",
                                    R"({"do":"task","tasks":[{"turn_valve":{"to_deg":45}}]})",
                                    R"({"do":"task","tasks":[{"press_buttons":{"order":["left","centre"]}},{"turn_valve":{"to_deg":0}}]})",
                                    R"({"do":"commission","joints":["roll"],"clear":true,"moved":true})",
                                    R"({"do":"restart-bus"})"};
  std::array<std::string, 14> values_{"null",
                                      "true",
                                      "{}",
                                      "[]",
                                      "\"\"",
                                      "1e308",
                                      "-1e999",
                                      "NaN",
                                      "[{}]",
                                      "\"\\u0000\"",
                                      "\"\\ud800\"",
                                      "{\"to_deg\":[]}",
                                      "9999999999999999999999",
                                      "\xc3"};
};

TEST(ParseOrder, NoLineDoesMoreThanItSays) {
  constexpr unsigned seed = 20261122;
  SCOPED_TRACE("seed " + std::to_string(seed));
  Mutator mutator(seed);
  int taken = 0, refused = 0;
  for (int i = 0; i < 100'000; ++i) {
    const std::string line = mutator.line();
    ParsedOrder parsed;
    ASSERT_NO_THROW(parsed = parse_order(line)) << line;
    if (const auto* why = std::get_if<std::string>(&parsed)) {
      ++refused;
      ASSERT_FALSE(why->empty()) << line;
      ASSERT_LT(why->size(), 300u) << line;
      ASSERT_EQ(why->find('\n'), std::string::npos) << line;
      ASSERT_NO_THROW((void)nlohmann::json(*why).dump()) << line;
      continue;
    }
    ++taken;
    const OperatorRequest& request = std::get<OperatorRequest>(parsed);
    ASSERT_NE(request.right, nullptr) << line;
    ASSERT_EQ(nlohmann::json::parse(line)["do"], request.right->request) << line;
    ASSERT_LE(std::abs(request.order.by_rad), mission::largest_jog_rad) << line;
    const PerJoint<bool>& joints = request.commission.joints;
    ASSERT_TRUE(!request.commission.moved || std::count(joints.begin(), joints.end(), true) == 1) << line;
    for (const mission::Task& task : request.order.tasks) ASSERT_LE(std::abs(task.to_rad), 3.1415926536) << line;
  }
  EXPECT_GT(taken, 20'000);  // both sides of the border are walked
  EXPECT_GT(refused, 20'000);
}

}  // namespace
}  // namespace lf::hal
