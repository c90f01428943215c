// A panel's file: what it says comes through, and what is wrong with it is told with its place.
#include "hal/config/panel_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <regex>

#include "hal/config/panel_check.hpp"
#include "hal/config/share.hpp"
#include "hal/config/text_file.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::config {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::string good = R"(version: 1
plate:
  min_m: [-0.5, -0.4]
  max_m: [0.5, 0.3]
  thickness_m: 0.012
valves:
  - name: V1
    at_m: [-0.125, 0.01]
    length_m: 0.12
    thickness_m: 0.02
    height_m: 0.11
    pointer: dark_end
    pointer_length_m: 0.025
    stop_min_deg: -10
    stop_max_deg: 100
    torque_nm: 8
    friction_nm: {min: 1, max: 2.5}
    start_deg: 20
    detents_deg: [0, 90]
    detent_nm: 0.2
    viscous_nm_s: 0.1
  - {name: V2, at_m: [0.125, 0]}
buttons:
  - {name: B1, at_m: [0, 0.15], width_m: 0.05, height_m: 0.028, stroke_m: 0.004}
  - {name: B2, at_m: [0.1, 0.15]}
markers:
  - {id: 11, at_m: [-0.3, 0.1], size_m: 0.06, plate_m: 0.08}
  - {id: 12, at_m: [0.3, 0.1]}
)";

// The good file with one place of it changed.
std::string with(const std::string& was, const std::string& is) {
  const std::size_t at = good.find(was);
  if (at == std::string::npos) ADD_FAILURE() << "the good file has no '" << was << "'";
  return at == std::string::npos ? good : std::string(good).replace(at, was.size(), is);
}

PanelFile read(const std::string& text) {
  const test::TemporaryFolder folder;
  return read_panel_file(folder.write("panel.yaml", text));
}

// What is said of it, less the file's name, which begins each line; "" when it is taken.
std::string complaint(const std::string& text) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("panel.yaml", text);
  try {
    (void)read_panel_file(file);
    return "";
  } catch (const InputError& problem) {
    std::istringstream lines(problem.what());
    std::string told;
    for (std::string line; std::getline(lines, line);) {
      EXPECT_THAT(line, StartsWith(file + ":"));
      told += (told.empty() ? "" : "\n") + (line.starts_with(file) ? line.substr(file.size()) : line);
    }
    return told.empty() ? "an empty text" : told;
  }
}

TEST(PanelFile, GivesWhatIsWritten) {
  const PanelFile panel = read(good);
  const PanelLayout& layout = panel.layout;
  EXPECT_EQ(layout.plate_min_m, Vec2(-0.5, -0.4));
  EXPECT_EQ(layout.plate_max_m, Vec2(0.5, 0.3));
  EXPECT_EQ(layout.plate_thickness_m, 0.012);
  EXPECT_THAT(panel.survey.file, testing::EndsWith("panel.yaml"));
  EXPECT_THAT(panel.survey.names.valves, ElementsAre("V1", "V2"));
  EXPECT_THAT(panel.survey.names.buttons, ElementsAre("B1", "B2"));
  EXPECT_THAT(panel.survey.names.markers, ElementsAre("11", "12"));

  ASSERT_EQ(layout.valves.size(), 2u);
  const PanelLayout::Valve& valve = layout.valves[0];
  EXPECT_EQ(valve.at_m, Vec2(-0.125, 0.01));
  EXPECT_EQ(valve.handle_length_m, 0.12);
  EXPECT_EQ(valve.handle_thickness_m, 0.02);
  EXPECT_EQ(valve.handle_height_m, 0.11);
  EXPECT_EQ(valve.pointer, PanelLayout::Pointer::dark_end);
  EXPECT_EQ(valve.pointer_length_m, 0.025);
  EXPECT_EQ(valve.handle_min_rad, rad_from_deg(-10));
  EXPECT_EQ(valve.handle_max_rad, rad_from_deg(100));
  ASSERT_EQ(panel.survey.valves.size(), 2u);
  const ValveNature& nature = panel.survey.valves[0];
  EXPECT_EQ(nature.torque_nm, 8);
  EXPECT_EQ(nature.friction_nm, (Spread{1, 2.5}));
  EXPECT_EQ(nature.start_deg, Spread::fixed(20));
  EXPECT_THAT(nature.detents_deg, ElementsAre(0, 90));
  EXPECT_EQ(nature.detent_nm, 0.2);
  EXPECT_EQ(nature.viscous_nm_s, 0.1);

  ASSERT_EQ(layout.buttons.size(), 2u);
  EXPECT_EQ(layout.buttons[0].at_m, Vec2(0, 0.15));
  EXPECT_EQ(layout.buttons[0].width_m, 0.05);
  EXPECT_EQ(layout.buttons[0].height_m, 0.028);
  EXPECT_EQ(layout.buttons[0].stroke_m, 0.004);
  ASSERT_EQ(layout.markers.size(), 2u);
  EXPECT_EQ(layout.markers[0].id, 11);
  EXPECT_EQ(layout.markers[0].centre_m, Vec2(-0.3, 0.1));
  EXPECT_EQ(layout.markers[0].size_m, 0.06);
  EXPECT_EQ(layout.markers[0].plate_m, 0.08);
}

TEST(PanelFile, WhatIsLeftOutIsAsOnTheDockedMissionsPanel) {
  const PanelFile panel = read(good);
  const PanelLayout::Valve& valve = panel.layout.valves[1];
  const PanelLayout::Valve usual;
  EXPECT_EQ(valve.at_m, Vec2(0.125, 0));
  EXPECT_EQ(valve.handle_length_m, usual.handle_length_m);
  EXPECT_EQ(valve.handle_thickness_m, usual.handle_thickness_m);
  EXPECT_EQ(valve.handle_height_m, usual.handle_height_m);
  EXPECT_EQ(valve.pointer, usual.pointer);
  EXPECT_EQ(valve.handle_min_rad, usual.handle_min_rad);
  EXPECT_EQ(valve.handle_max_rad, usual.handle_max_rad);
  EXPECT_EQ(panel.survey.valves[1].torque_nm, ValveNature{}.torque_nm);
  EXPECT_EQ(panel.survey.valves[1].friction_nm, ValveNature{}.friction_nm);
  EXPECT_EQ(panel.layout.buttons[1].width_m, PanelLayout::Button{}.width_m);
  EXPECT_EQ(panel.layout.markers[1].plate_m, PanelLayout::Marker{}.plate_m);
  EXPECT_EQ(read(with("  thickness_m: 0.012\n", "")).layout.plate_thickness_m, PanelLayout{}.plate_thickness_m);
}

TEST(PanelFile, AHandlesKindSaysWhatItsSizesAreWhereTheyAreLeftOut) {
  const auto valve = [](const std::string& more) { return read(with("name: V2", more + ", name: V2")).layout.valves[1]; };
  const PanelLayout::Valve bar = valve("kind: t_bar");
  EXPECT_EQ(bar.depth_m(), bar.handle_thickness_m);
  EXPECT_EQ(bar.seen_height_m(), bar.handle_height_m);
  EXPECT_EQ(bar.carried, PanelLayout::Carried::by_stem);
  const PanelLayout::Valve paddle = valve("kind: paddle");
  EXPECT_NEAR(paddle.depth_m(), 0.040, 1e-9);
  EXPECT_NEAR(paddle.front_m(), 0.120, 1e-9);
  EXPECT_NEAR(paddle.seen_height_m(), 0.115, 1e-9) << "the middle of a bar of 10 mm with this front";
  EXPECT_EQ(paddle.handle_thickness_m, 0.010);
  EXPECT_NEAR(valve("kind: fishtail").depth_m(), 0.030, 1e-9);
  EXPECT_NEAR(valve("kind: fishtail, depth_m: 0.02, thickness_m: 0.014").depth_m(), 0.020, 1e-9) << "what is said counts";
  EXPECT_EQ(valve("kind: fishtail, thickness_m: 0.014").handle_thickness_m, 0.014);
  const PanelLayout::Valve d = valve("kind: d_handle");
  EXPECT_EQ(d.carried, PanelLayout::Carried::by_posts);
  EXPECT_EQ(d.handle_length_m, 0.120);
  EXPECT_EQ(d.depth_m(), d.handle_thickness_m);
}

TEST(PanelFile, WhatIsNotSaidOfAValvesFrictionIsNoMoreThanItsTorque) {
  EXPECT_EQ(read(with("name: V2", "torque_nm: 1, name: V2")).survey.valves[1].friction_nm, (Spread{0.5, 1}));
  EXPECT_EQ(read(with("name: V2", "torque_nm: 0, name: V2")).survey.valves[1].friction_nm, Spread::fixed(0));
}

TEST(PanelFile, ANameHasUpToFortyLetters) {
  const std::string name = std::string(38, 'V') + "-2";
  EXPECT_THAT(read(with("name: V2", "name: " + name)).survey.names.valves, ElementsAre("V1", name));
}

TEST(PanelFile, MayHaveAMarkerAlone) {
  const PanelFile panel = read("version: 1\nmarkers: [{id: 7, at_m: [-0.17, 0.072]}]\n");
  EXPECT_EQ(panel.layout.valves.size() + panel.layout.buttons.size(), 0u);
  EXPECT_THAT(panel.survey.names.valves, IsEmpty());
  EXPECT_EQ(complaint("version: 1\nplate:\nvalves:\nbuttons: []\nmarkers: [{id: 7, at_m: [-0.17, 0.072]}]\n"), "");
}

struct BadPanel {
  const char* name;
  std::string text;
  const char* complaint;
};
void PrintTo(const BadPanel& bad, std::ostream* out) { *out << bad.name; }

class PanelFileRefused : public testing::TestWithParam<BadPanel> {};

TEST_P(PanelFileRefused, WithThePlaceAndTheCause) { EXPECT_THAT(complaint(GetParam().text), StartsWith(GetParam().complaint)); }

const BadPanel bad_panels[] = {
    {"MisspeltKey", with("length_m: 0.12\n", "lenght_m: 0.12\n"),
     ":9: unknown key 'valves[0].lenght_m'; did you mean 'valves[0].length_m'?"},
    {"MisspeltKeyOfAButton", with("width_m: 0.05", "widht_m: 0.05"),
     ":24: unknown key 'buttons[0].widht_m'; did you mean 'buttons[0].width_m'?"},
    {"MisspeltKeyOfThePlate", with("thickness_m: 0.012", "thicknes_m: 0.012"),
     ":5: unknown key 'plate.thicknes_m'; did you mean 'plate.thickness_m'?"},
    {"MisspeltList", with("valves:", "vavles:"), ":6: unknown key 'vavles'; did you mean 'valves'?"},
    {"KeyTwice", with("length_m: 0.12\n", "length_m: 0.12\n    length_m: 0.13\n"), ":10: 'valves[0].length_m' is given twice"},
    {"ListTwice", good + "valves: []\n", ":29: 'valves' is given twice"},
    {"NoVersion", with("version: 1\n", ""), ":1: has no version: this program reads 'version: 1'"},
    {"VersionOfTomorrow", with("version: 1", "version: 2"), ":1: 'version' is 2, out of its range 1 to 1"},
    {"VersionInWords", with("version: 1", "version: one"), ":1: 'version' takes a whole number, not 'one'"},
    {"NoMarkers", good.substr(0, good.find("markers:")), ":1: has no markers: no look would find the panel"},
    {"EmptyMarkers", good.substr(0, good.find("markers:")) + "markers: []\n", ":1: has no markers"},
    {"NoName", with("name: V2, ", ""), ":22: 'valves[1]' has no name"},
    {"EmptyName", with("name: V2", "name: ''"), ":22: 'valves[1]' has no name"},
    {"NoPlace", with("name: B2, at_m: [0.1, 0.15]", "name: B2"), ":25: 'buttons[1]' has no at_m"},
    {"NoId", with("id: 12, ", ""), ":28: 'markers[1]' has no id"},
    {"NameTwice", with("name: V2", "name: V1"), ":22: 'valves[1].name': there is another 'V1'"},
    {"NameOfAButtonTwice", with("name: B2", "name: B1"), ":25: 'buttons[1].name': there is another 'B1'"},
    {"NameWithABlank", with("name: V2", "name: V 2"), ":22: 'valves[1].name': a name is of 1 to 40 letters of ASCII"},
    {"NameWithAComma", with("name: V2", "name: 'V,2'"), ":22: 'valves[1].name': a name is of 1 to 40 letters of ASCII"},
    {"NameWithAQuote", with("name: V2", "name: V'2"), ":22: 'valves[1].name': a name is of 1 to 40 letters of ASCII"},
    {"NameWithAnEqualsSign", with("name: V2", "name: V=2"), ":22: 'valves[1].name': a name is of 1 to 40 letters of ASCII"},
    {"NameWithABackslash", with("name: V2", "name: V\\2"), ":22: 'valves[1].name': a name is of 1 to 40 letters of ASCII"},
    {"NameThatIsNoText", with("name: V2", "name: V\xFF"), ":22: 'valves[1].name': a name is of 1 to 40 letters of ASCII"},
    {"NameThatIsTooLong", with("name: V2", "name: " + std::string(41, 'V')),
     ":22: 'valves[1].name': a name is of 1 to 40 letters of ASCII"},
    {"NameThatIsAList", with("name: V2", "name: [V2]"), ":22: 'valves[1].name' takes"},
    {"KindMisspelt", with("name: V2", "kind: padle, name: V2"), ":22: 'valves[1].kind' has no 'padle'; did you mean 'paddle'?"},
    {"IdTwice", with("id: 12", "id: 11"), ":28: 'markers.11.id': 11 is marker 11's too: a look would not tell them apart"},
    {"IdOfAnotherFamily", with("id: 12", "id: 587"), ":28: 'markers[1].id' is 587, out of its range 0 to 586"},
    {"IdInPart", with("id: 12", "id: 1.5"), ":28: 'markers[1].id' takes a whole number, not '1.5'"},
    {"FrictionAboveTorque", with("torque_nm: 8", "torque_nm: 2"), ":7: 'valves[0].friction_nm' is more than its 'torque_nm'"},
    {"StartBeyondItsStop", with("start_deg: 20", "start_deg: 101"), ":7: 'valves[0].start_deg' is beyond its stops"},
    {"StartBeyondTheOtherStop", with("start_deg: 20", "start_deg: {min: -11, max: 20}"), ":7: 'valves[0].start_deg' is beyond its stops"},
    {"StopsTheWrongWay", with("stop_min_deg: -10", "stop_min_deg: 100"),
     ":7: 'valves[0].stop_min_deg' is not below 'valves[0].stop_max_deg'"},
    {"PlateInsideOut", with("min_m: [-0.5, -0.4]", "min_m: [-0.5, 0.3]"), ":3: 'plate.min_m' is not below 'plate.max_m'"},
    {"PlateThatIsANumber", "version: 1\nplate: 3\nmarkers: [{id: 7, at_m: [-0.17, 0.072]}]\n", ":2: 'plate' takes a group of keys"},
    {"PlateThatIsAList", "version: 1\nplate: [1, 2]\nmarkers: [{id: 7, at_m: [-0.17, 0.072]}]\n", ":2: 'plate' takes a group of keys"},
    {"MarkerThatIsNoSmallerThanItsPlate", with("plate_m: 0.08", "plate_m: 0.06"),
     ":27: 'markers[0].plate_m' is not larger than 'markers[0].size_m'"},
    // Swept are 60.8 and 48.7 mm about axes 75 mm apart, and 48.7 and 20 mm about 50.
    {"BarsThatOverlap", with("at_m: [0.125, 0]", "at_m: [-0.05, 0.01]"),
     ":22: 'valves.V2.at_m': its turning bar and that of V1 overlap by 34.5 mm: see 'valves.V2.length_m'"},
    {"ButtonUnderABar", with("at_m: [0.1, 0.15]", "at_m: [0.125, 0.05]"),
     ":25: 'buttons.B2.at_m': the B2 button lies 18.7 mm under the turning bar: see 'buttons.B2.width_m', 'valves.V2.length_m' and "
     "'valves.V2.thickness_m'"},
    {"MarkerUnderABar", with("at_m: [0.3, 0.1]", "at_m: [0.2, 0]"),
     ":28: 'markers.12.at_m': the turning bar covers marker 12's plate by 23.7 mm: no look would find the marker. See "
     "'valves.V2.length_m'"},
    {"ButtonsThatOverlap", with("at_m: [0.1, 0.15]", "at_m: [0.04, 0.15]"),
     ":25: 'buttons.B2.at_m': the B2 button and the B1 one overlap by 5.0 mm: see 'buttons.B2.width_m'"},
    {"MarkerOverThePlatesEdge", with("at_m: [0.3, 0.1]", "at_m: [0.46, 0.1]"),
     ":28: 'markers.12.at_m': marker 12's plate hangs beyond the panel's: see 'plate.min_m', 'plate.max_m' and 'markers.12.plate_m'"},
    {"MarkersThatOverlap", with("at_m: [0.3, 0.1]", "at_m: [-0.3, 0.02]"),
     ":28: 'markers.12.at_m': its plate and that of marker 11 overlap by 10.0 mm"},
    {"ValveBeyondThePlate", with("at_m: [0.125, 0]", "at_m: [0.6, 0]"),
     ":22: 'valves.V2.at_m': the valve stands beyond the plate: see 'plate.min_m', 'plate.max_m'"},
    {"NotANumber", with("thickness_m: 0.012", "thickness_m: .nan"), ":5: 'plate.thickness_m' must be a finite number, not .nan"},
    {"NotANumberInAList", with("at_m: [0.125, 0]", "at_m: [.nan, 0]"), ":22: 'valves[1].at_m' must be a finite number, not .nan"},
    {"Infinite", with("torque_nm: 8", "torque_nm: .inf"), ":16: 'valves[0].torque_nm' must be a finite number, not .inf"},
    {"Huge", with("length_m: 0.12", "length_m: 1e9"), ":9: 'valves[0].length_m' is 1e9, out of its range 0.06 to 0.16 m"},
    {"TooLargeToHold", with("length_m: 0.12", "length_m: 1e999"), ":9: 'valves[0].length_m' must be a finite number"},
    {"TextForANumber", with("length_m: 0.12", "length_m: long"), ":9: 'valves[0].length_m' takes a number, not 'long'"},
    {"PlaceOfThreeNumbers", with("at_m: [0.125, 0]", "at_m: [0.125, 0, 0]"), ":22: 'valves[1].at_m' takes a list of 2 numbers"},
    {"ForeignPointer", with("pointer: dark_end", "pointer: dark_ned"),
     ":12: 'valves[0].pointer' has no 'dark_ned'; did you mean 'dark_end'?"},
    {"ListThatIsNone", "version: 1\nvalves: 3\nmarkers: [{id: 7, at_m: [-0.17, 0.072]}]\n", ":2: 'valves' takes a list"},
    {"EntryThatIsAWord", with("{name: V2, at_m: [0.125, 0]}", "V2"), ":22: 'valves[1]' takes a group of keys"},
    {"Empty", "", ": a panel is a group of keys"},
    {"CommentsAlone", "# nothing\n", ": a panel is a group of keys"},
    {"AList", "- 1\n", ":1: a panel is a group of keys"},
    {"AWord", "panel\n", ":1: a panel is a group of keys"},
    {"NotYaml", with("[0.1, 0.15]", "[0.1, 0.15"), ":25: not YAML"},
    {"SecondDocument", good + "---\nversion: 1\n", ":29: a second document begins here"},
};
INSTANTIATE_TEST_SUITE_P(PanelFile, PanelFileRefused, testing::ValuesIn(bad_panels),
                         [](const auto& test) { return std::string(test.param.name); });

// So many of each kind on a grid of their own, on a plate of 4 m.
std::string crowd(int valves, int buttons, int markers) {
  std::string text = "version: 1\nplate: {min_m: [-2, -2], max_m: [2, 2]}\n";
  const auto list = [&](const char* kind, int count, double y_m, const auto& head) {
    text += std::string(kind) + ":\n";
    for (int i = 0; i < count; ++i)
      text += "  - {" + head(i) + ", at_m: [" + std::to_string(-1.8 + 0.21 * i) + ", " + std::to_string(y_m) + "]}\n";
  };
  list("valves", valves, 1.5, [](int i) { return "name: V" + std::to_string(i); });
  list("buttons", buttons, 0, [](int i) { return "name: B" + std::to_string(i); });
  list("markers", markers, -1.5, [](int i) { return "id: " + std::to_string(i); });
  return text;
}

TEST(PanelFile, HoldsSixteenOfEachKindAndTellsHowManyThereAre) {
  const PanelFile full = read(crowd(16, 16, 16));
  EXPECT_EQ(full.layout.valves.size(), 16u);
  EXPECT_EQ(full.layout.buttons.size(), 16u);
  EXPECT_EQ(full.layout.markers.size(), 16u);
  EXPECT_EQ(full.survey.names.markers[15], "15");
  EXPECT_THAT(complaint(crowd(17, 0, 1)), HasSubstr("'valves' has 17, and a panel holds 16"));
  EXPECT_THAT(complaint(crowd(1, 17, 1)), HasSubstr("'buttons' has 17, and a panel holds 16"));
  EXPECT_THAT(complaint(crowd(1, 1, 18)), HasSubstr("'markers' has 18, and a panel holds 16"));
}

TEST(PanelFile, TellsAllItsProblemsAtOnceEachWithItsLine) {
  std::string text = with("length_m: 0.12\n", "lenght_m: 0.12\n");
  text.replace(text.find("name: B1"), 8, "name: B 1");
  text.replace(text.find("id: 12"), 6, "id: -1");
  EXPECT_THAT(complaint(text), AllOf(HasSubstr(":9: unknown key"), HasSubstr(":24: 'buttons[0].name'"), HasSubstr(":28: 'markers[1].id'")));
}

TEST(PanelFile, OneThatIsNotThereOrAFolderIsTold) {
  const test::TemporaryFolder folder;
  for (const std::string& file : {folder / "none.yaml", folder.path().string()})
    EXPECT_THAT(test::message_of<InputError>([&] { (void)read_panel_file(file); }), StartsWith(file + ": "));
}

// Damage of one place: it is read, or refused by the file's name on each line; nothing else comes out, and what is read is fit to be used.
TEST(PanelFile, DamagedIsReadOrRefused) {
  constexpr unsigned seed = 20261128;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  std::vector<std::string> lines;
  std::istringstream in(good);
  for (std::string line; std::getline(in, line);) lines.push_back(line + "\n");
  const std::regex number("[ \\[{](-?[0-9]+(\\.[0-9]+)?)");
  const std::vector<std::string> others{"-1", "1e9", ".nan", "text"};
  const test::TemporaryFolder folder;
  int taken = 0, refused = 0;
  for (int i = 0; i < 200; ++i) {
    std::vector<std::string> damaged = lines;
    const std::size_t at = below(lines.size()), kind = below(4);
    if (kind == 0) damaged.erase(damaged.begin() + static_cast<std::ptrdiff_t>(at));
    if (kind == 1) damaged.insert(damaged.begin() + static_cast<std::ptrdiff_t>(at), lines[at]);
    if (kind == 2) {
      std::vector<std::smatch> numbers(std::sregex_iterator(lines[at].begin(), lines[at].end(), number), {});
      if (numbers.empty()) continue;
      const std::smatch& one = numbers[below(numbers.size())];
      damaged[at].replace(static_cast<std::size_t>(one.position(1)), static_cast<std::size_t>(one.length(1)), others[below(others.size())]);
    }
    std::string text;
    for (const std::string& line : damaged) text += line;
    if (kind == 3) text.resize(below(text.size()));
    SCOPED_TRACE(text);
    const std::string file = folder.write("damaged.yaml", text);
    try {
      const PanelFile panel = read_panel_file(file);
      ++taken;
      EXPECT_FALSE(panel.layout.markers.empty());
      EXPECT_EQ(panel.layout.valves.size(), panel.survey.names.valves.size());
      EXPECT_EQ(panel.layout.valves.size(), panel.survey.valves.size());
      EXPECT_EQ(panel.layout.buttons.size(), panel.survey.names.buttons.size());
      EXPECT_EQ(panel.layout.markers.size(), panel.survey.names.markers.size());
      EXPECT_THAT(panel_problems(panel.layout, panel.survey), IsEmpty());
    } catch (const InputError& problem) {
      ++refused;
      std::istringstream told(problem.what());
      int count = 0;
      for (std::string line; std::getline(told, line); ++count) EXPECT_THAT(line, StartsWith(file + ":"));
      EXPECT_GT(count, 0);
    } catch (const std::exception& other) {
      ADD_FAILURE() << "not an InputError: " << other.what();
    }
  }
  EXPECT_GT(taken, 10);
  EXPECT_GT(refused, 50);
}

// What a scenario in this folder makes of its keys.
struct Settled {
  bool read = false;
  PanelLayout layout;
  PanelSurvey survey;
  std::vector<std::string> problems;
};
Settled settle(const std::string& told_in, const std::string& file, const DockedPanel& docked, const ValveStops& stops) {
  Settled settled;
  settled.read = settle_panel(told_in, file, docked, stops, settled.layout, settled.survey, settled.problems);
  return settled;
}

TEST(SettlePanel, BesideAFileKeepsWhereThePanelStands) {
  const test::TemporaryFolder folder;
  folder.write("panel.yaml", good);
  DockedPanel docked;
  docked.nominal_x_m = 0.5;
  docked.nominal_y_m = -0.1;
  docked.nominal_z_m = 0.6;
  const Settled settled = settle(folder / "mine.yaml", "panel.yaml", docked, {});
  EXPECT_TRUE(settled.read);
  EXPECT_THAT(settled.problems, IsEmpty());
  EXPECT_EQ(settled.layout.nominal_x_m, 0.5);
  EXPECT_EQ(settled.layout.nominal_y_m, -0.1);
  EXPECT_EQ(settled.layout.nominal_z_m, 0.6);
  EXPECT_THAT(settled.survey.names.valves, ElementsAre("V1", "V2"));
  EXPECT_EQ(settled.layout.valves[0].handle_length_m, 0.12);
}

TEST(SettlePanel, BesideAFileNamesEachKeyOfTheDockedMissionsPanel) {
  const test::TemporaryFolder folder;
  folder.write("panel.yaml", good);
  const std::string told_in = folder / "mine.yaml";
  DockedPanel docked;
  docked.handle_length_m = 0.11;
  docked.buttons_m[1] = Vec2(0.01, 0.186);
  docked.marker_id = 3;
  docked.pointer = PanelLayout::Pointer::none;
  ValveStops stops;
  stops.stop_max_deg = 90;
  const Settled settled = settle(told_in, "panel.yaml", docked, stops);
  std::vector<std::string> expected;
  for (const char* key : {"panel.handle_length_m", "panel.pointer", "panel.buttons_m", "panel.marker_id", "valve.stop_max_deg"})
    expected.push_back(told_in + ": '" + key + "' is of the docked mission's panel: 'panel.file' says what is on this one");
  EXPECT_THAT(settled.problems, testing::UnorderedElementsAreArray(expected));
}

TEST(SettlePanel, WithoutAFileIsMadeOfTheKeys) {
  DockedPanel docked;
  docked.nominal_x_m = 0.5;
  docked.handle_length_m = 0.11;
  docked.buttons_m[1] = Vec2(0.01, 0.186);
  docked.button_stroke_m = 0.004;
  docked.marker_centre_m = Vec2(-0.2, 0.1);
  ValveStops stops;
  stops.stop_min_deg = -90;
  const Settled settled = settle("mine.yaml", "", docked, stops);
  EXPECT_TRUE(settled.read);
  EXPECT_THAT(settled.problems, IsEmpty());
  EXPECT_EQ(settled.survey.file, "");
  EXPECT_THAT(settled.survey.names.buttons, ElementsAre("left", "centre", "right"));
  EXPECT_EQ(settled.layout.nominal_x_m, 0.5);
  EXPECT_EQ(settled.layout.valves[0].handle_length_m, 0.11);
  EXPECT_EQ(settled.layout.valves[0].handle_min_rad, rad_from_deg(-90));
  EXPECT_EQ(settled.layout.buttons[1].at_m, Vec2(0.01, 0.186));
  for (const PanelLayout::Button& button : settled.layout.buttons) EXPECT_EQ(button.stroke_m, 0.004);
  EXPECT_EQ(settled.layout.markers[0].centre_m, Vec2(-0.2, 0.1));
}

TEST(SettlePanel, OfAFileThatCannotBeReadIsToldAndIsTheDockedMissions) {
  const test::TemporaryFolder folder;
  folder.write("bad.yaml", with("version: 1", "version: 2"));
  const auto settled = [&](const std::string& file) { return settle(folder / "mine.yaml", file, {}, {}); };
  const Settled bad = settled("bad.yaml");
  EXPECT_FALSE(bad.read);
  EXPECT_THAT(bad.problems, ElementsAre(HasSubstr("bad.yaml:1: 'version' is 2")));
  EXPECT_EQ(bad.survey.file, "");
  EXPECT_EQ(bad.layout.valves.size(), 1u);
  EXPECT_THAT(settled("none.yaml").problems, ElementsAre(HasSubstr("mine.yaml: 'panel.file': there is no none.yaml")));
  EXPECT_THAT(settled("pandra").problems, ElementsAre(HasSubstr("no shipped panel 'pandra'; did you mean 'pandora'?")));
  EXPECT_THAT(settled("zzz").problems, ElementsAre(HasSubstr("no shipped panel 'zzz'; there are after_17h, docked, pandora")));
}

TEST(ShippedPanels, AreReadAndTheDockedOneIsTheDefault) {
  ASSERT_THAT(shipped_panels(), testing::IsSupersetOf({"docked", "pandora"}));
  for (const std::string& name : shipped_panels()) EXPECT_NO_THROW((void)read_panel_file(share_folder() / panel_file_of(name))) << name;
  const PanelFile docked = read_panel_file(share_folder() / panel_file_of("docked"));
  const PanelLayout usual;
  EXPECT_EQ(docked.layout.plate_min_m, usual.plate_min_m);
  EXPECT_EQ(docked.layout.plate_max_m, usual.plate_max_m);
  ASSERT_EQ(docked.layout.valves.size(), 1u);
  EXPECT_EQ(docked.layout.valves[0].at_m, usual.valves[0].at_m);
  EXPECT_EQ(docked.layout.valves[0].handle_length_m, usual.valves[0].handle_length_m);
  ASSERT_EQ(docked.layout.buttons.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(docked.layout.buttons[i].at_m, usual.buttons[i].at_m) << i;
  ASSERT_EQ(docked.layout.markers.size(), 1u);
  EXPECT_EQ(docked.layout.markers[0].id, usual.markers[0].id);
  EXPECT_EQ(docked.layout.markers[0].centre_m, usual.markers[0].centre_m);
  const PanelNames names;
  EXPECT_EQ(docked.survey.names.valves, names.valves);
  EXPECT_EQ(docked.survey.names.buttons, names.buttons);
}

// Regenerate with: lanternfish scenarios --panel-schema > shared/panels/panel.schema.json; the page's table with --panel-keys.
TEST(ShippedPanels, TheSchemaAndTheUsersPageAreThoseOfTheTable) {
  const std::string source = LANTERNFISH_SOURCE_DIR;
  EXPECT_EQ(read_text_file(source + "/shared/panels/panel.schema.json"), panel_schema());
  EXPECT_THAT(read_text_file(source + "/docs/your-panel.md"), HasSubstr(panel_keys_markdown()));
}

}  // namespace
}  // namespace lf::config
