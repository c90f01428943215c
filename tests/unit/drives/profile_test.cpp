// Profiles as data: what is wrong with a file, all of it, and how its words become the core's numbers.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "hal/config/drive_kind.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::config {
namespace {

std::string problems_of(const std::string& text) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "mine.yaml";
  std::ofstream(file) << text;
  try {
    (void)read_drive_kind(file);
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "";
}

constexpr const char* whole = R"(title: mine
position: {units_per_count: 1}
speed: {units_per_rev_s: 60}
acceleration: {units_per_rev_s2: 60}
torque: {basis: torque}
)";

TEST(DriveProfileFile, EveryShippedOneIsReadAndApplied) {
  for (const std::string& name : shipped_drive_kinds()) {
    SCOPED_TRACE(name);
    const DriveKind kind = find_drive_kind(name, "");
    canopen::DriveSetup setup;
    EXPECT_NO_THROW(apply(kind, {64, 0.5, 1.3, false}, "here", setup));
    EXPECT_TRUE(setup.profile.scale.valid());
  }
}

TEST(DriveProfileFile, AllThatIsWrongIsListedWithItsLine) {
  const std::string problems = problems_of(R"(title: mine
positoin: {units_per_count: 1}
speed: {units_per_rev_s: 60, units_per_count_s: 1}
acceleration: {units_per_rev_s2: fast}
torque: {basis: torqe}
check:
  - {object: 60A8, type: u33, value: 1}
  - {object: "60A8:00", type: u32, value: rated_curent_ma}
absent:
  - {object: "6072:00", by: vendor_limits}
  - {object: "607C:00", by: other_object}
errors: {"86": short}
)");
  for (const char* part :
       {"mine.yaml:2: unknown key 'positoin'; did you mean 'position'", "mine.yaml:4: 'acceleration.units_per_rev_s2' takes a number",
        "did you mean 'torque'", "mine.yaml:3: 'speed' takes one scale", "'position' takes one scale", "did you mean 'u32'",
        "did you mean 'rated_current_ma'", "did you mean 'vendor_limit'", "'use' names the other object",
        "an error code is 4 hex digits"}) {
    EXPECT_NE(problems.find(part), std::string::npos) << part << "\nin\n" << problems;
  }
}

TEST(DriveProfileFile, TheUsersPageHasAWholeOne) {
  std::ifstream file(std::string(LANTERNFISH_SOURCE_DIR) + "/docs/canopen.md");
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  const std::string open = "<!-- profile: a test reads it -->\n```yaml\n";
  const std::size_t begin = page.find(open);
  ASSERT_NE(begin, std::string::npos);
  const std::size_t from = begin + open.size();
  EXPECT_EQ(problems_of(page.substr(from, page.find("```", from) - from)), "");
}

// Every pair of an object and a `by` is held against the users' page: a drive without 1016 and with another word than node_guarding would run on when its
// master dies.
TEST(DriveProfileFile, AnObjectsPlaceIsTakenOnlyByWhatThePageSays) {
  std::ifstream page(std::string(LANTERNFISH_SOURCE_DIR) + "/docs/canopen.md");
  std::map<std::string, std::string> allowed;  // by word: a list of objects
  bool in_table = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| `by` |")) in_table = true;
    if (in_table && line.empty()) break;
    if (!in_table || !line.starts_with("| `") || line.starts_with("| `by`")) continue;
    const std::size_t end = line.find("` | ");
    allowed[line.substr(3, end - 3)] = line.substr(end + 4, line.find(" |", end + 4) - end - 4);
  }
  ASSERT_EQ(allowed.size(), 9u);
  std::set<std::string> objects;
  for (const auto& [by, list] : allowed) {
    for (std::size_t at = 0; at < list.size(); at += 9) objects.insert(list.substr(at, 7));
  }
  EXPECT_EQ(objects.size(), 22u);
  for (const auto& [by, list] : allowed) {
    for (const std::string& object : objects) {
      const std::string use = by == "other_object" ? ", use: \"30B0:00\"" : "";
      const std::string rated = by == "configured_rating" ? ", rating: configured" : "";
      std::string text = std::string(whole) + "absent: [{object: \"" + object + "\", by: " + by + use + "}]\n";
      text.insert(text.find("basis: torque") + 13, rated);
      const std::string problems = problems_of(text);
      if (list.find(object) != std::string::npos) {
        EXPECT_EQ(problems, "") << object << " " << by;
      } else {
        EXPECT_NE(problems.find("mine.yaml:6: object " + object + ": 'by' takes "), std::string::npos) << object << " " << by << problems;
      }
    }
  }
  EXPECT_NE(problems_of(std::string(whole) + "absent: [{object: \"1016:01\", by: vendor_limit}]\n").find("'by' takes node_guarding"),
            std::string::npos);
  EXPECT_NE(problems_of(std::string(whole) + "absent: [{object: \"6076:00\", by: configured_rating}]\n").find("'torque.rating' is object"),
            std::string::npos);
}

// A group's name with a plain value ended the program: the YAML library throws an error of its own for a member of what is no group.
TEST(DriveProfileFile, AGroupThatIsNoneIsRefusedInWords) {
  for (const char* group : {"homing", "identity", "position", "torque", "options", "brake"}) {
    const std::string problems = problems_of(std::string("title: mine\n") + group + ": none\n");
    EXPECT_NE(problems.find(std::string("mine.yaml:2: '") + group + "' takes a group of keys"), std::string::npos) << problems;
  }
}

// A profile that wrote the controlword gave a drive power while the boot ran, before the emergency-stop chain was heard.
TEST(DriveProfileFile, WhatTheMasterWritesItselfIsNoProfilesToWrite) {
  for (const char* object : {"6040:00", "6060:00", "607A:00", "1016:01", "1017:00", "1400:01", "1A00:00", "605A:00", "6007:00"}) {
    const std::string text = std::string(whole) + "write: [{object: \"" + object + "\", type: u16, value: 15}]\n";
    EXPECT_NE(problems_of(text).find(std::string("object ") + object + " is the master's to write"), std::string::npos) << object;
  }
  EXPECT_EQ(problems_of(std::string(whole) + "write: [{object: \"2F75:00\", type: u16, value: 5}]\n"), "");
}

TEST(DriveProfileFile, AValueThatDoesNotFitItsTypeIsRefused) {
  struct Case {
    const char *type, *fits, *does_not;
  };
  for (const Case& c : {Case{"u8", "255", "300"}, Case{"i8", "-128", "128"}, Case{"u16", "0xFFFF", "-5"}, Case{"i16", "-32768", "65538"},
                        Case{"u32", "4294967295", "-1"}, Case{"i32", "-2147483648", "2147483648"}}) {
    for (const char* list : {"write", "check"}) {
      const auto said = [&](const char* value) {
        return problems_of(std::string(whole) + list + ": [{object: \"2F75:00\", type: " + c.type + ", value: " + value + "}]\n");
      };
      EXPECT_EQ(said(c.fits), "") << c.type;
      EXPECT_NE(said(c.does_not).find(std::string("does not fit ") + c.type), std::string::npos) << said(c.does_not);
    }
  }
}

// The C++ library throws where the name of a file is too long to be one.
TEST(DriveProfileFile, ALikenessThatIsNoFilesNameIsRefusedInWords) {
  for (const char* like : {"epos5", "../epos4.yaml", "[epos4]"}) {
    const std::string problems = problems_of("title: mine\nlike: " + std::string(like) + "\n");
    for (const char* part :
         {"mine.yaml:2: ", "'like'", "the name of a shipped profile (c5e, cia402,", "the name without .yaml of a file in "})
      EXPECT_NE(problems.find(part), std::string::npos) << like << ": " << problems;
  }
  EXPECT_NE(problems_of("title: mine\nlike: " + std::string(300, 'x') + "\n").find("mine.yaml:2: no profile 'xxx"), std::string::npos);
}

TEST(DriveProfileFile, AWrongNumberOrNameIsToldWithItsLineAndWhatItTakes) {
  const auto said = [](const std::string& line) { return problems_of(std::string(whole) + line + "\n"); };
  const auto expect = [&](const std::string& line, const std::string& part) {
    EXPECT_NE(said(line).find("mine.yaml:6: " + part), std::string::npos) << said(line);
  };
  expect("identity: {vendor: 99999999999}", "'identity.vendor' takes a number from 0 to 0xFFFFFFFF, not '99999999999'");
  expect("identity: {product: -1}", "'identity.product' takes a number from 0 to 0xFFFFFFFF");
  expect("position_lost: [7320, \"xyz\"]", "'position_lost' takes EMCY codes of 4 hex digits in quotes, not 'xyz'");
  expect("absent: [{object: 1016, by: node_guarding}]",
         "'absent' names 1016:00, which the boot does not write and cannot do without; did you mean \"1016:01\"?");
  expect("absent: [{object: \"6041:00\", by: fixed_by_maker}]",
         "'absent' names 6041:00, which the boot does not write and cannot do without");
  expect("like: cia403", "no profile 'cia403' for 'like'; did you mean 'cia402'? It takes the name of a shipped profile");
  expect("like: nothing_like_it", "no profile 'nothing_like_it' for 'like'. It takes the name of a shipped profile");
}

TEST(DriveProfileFile, AScaleIsNeverAssumed) {
  EXPECT_EQ(problems_of(whole), "");
  for (const char* key : {"position", "speed", "acceleration", "torque"}) {
    std::string text = whole;
    const std::size_t at = text.find(std::string(key) + ":");
    text.erase(at, text.find('\n', at) - at + 1);
    const std::string reason = key == std::string("torque") ? "'torque.basis' is missing" : "'" + std::string(key) + "' takes one scale";
    EXPECT_NE(problems_of(text).find(reason), std::string::npos) << key << ": " << problems_of(text);
  }
}

// One of its own took its place beside the inherited one, and both were refused as two.
TEST(DriveProfileFile, AScaleOfItsOwnTakesThePlaceOfTheOneThatItWasLike) {
  EXPECT_EQ(problems_of("title: mine\nlike: cia402\nposition: {units_per_rev: 4096}\nspeed: {units_per_rev_s: 60}\n"), "");
  EXPECT_EQ(problems_of("title: mine\nlike: epos4\nposition: {units_per_count: 2}\n"), "");
  EXPECT_NE(problems_of("title: mine\nlike: cia402\nposition: {units_per_rev: 4096, units_per_count: 1}\n").find("takes one scale"),
            std::string::npos);
}

TEST(DriveProfileFile, AnUnknownProfileIsRefusedWithTheNearestName) {
  try {
    (void)find_drive_kind("epos5", "");
    FAIL();
  } catch (const InputError& problem) {
    EXPECT_NE(std::string(problem.what()).find("did you mean 'epos4'"), std::string::npos) << problem.what();
  }
}

TEST(DriveProfileFile, UnitsBecomeFractionsOfWholeNumbers) {
  const auto scale = [](const char* name, double counts_per_rev) {
    canopen::DriveSetup setup;
    apply(find_drive_kind(name, ""), {counts_per_rev, 1, 2, false}, "here", setup);
    return setup.profile.scale;
  };
  EXPECT_EQ(scale("c5e", 64).position.num, 225);  // tenths of a degree
  EXPECT_EQ(scale("c5e", 64).position.den, 4);
  EXPECT_EQ(scale("epos4", 64).speed.num, 15);  // rpm
  EXPECT_EQ(scale("epos4", 64).speed.den, 16);
  EXPECT_EQ(scale("ipos", 64).speed.times(1000), 65536);  // 1000 counts/s
  EXPECT_EQ(scale("ipos", 64).torque.times(1000), 1638);  // 2 A at 819 a A
  EXPECT_EQ(scale("copley", 64).speed.times(7), 70);
  EXPECT_EQ(scale("copley", 64).acceleration.times(70), 7);
  EXPECT_EQ(scale("ingenia", 64).speed.times(64), 1000);  // mrev/s
}

TEST(DriveProfileFile, WhatTheMachineDoesNotStateIsAskedFor) {
  canopen::DriveSetup setup;
  EXPECT_THROW(apply(find_drive_kind("ipos", ""), {64, 0, 1, false}, "here", setup), InputError);  // no rated torque
  EXPECT_THROW(apply(find_drive_kind("ipos", ""), {64, 1, 0, false}, "here", setup), InputError);  // no rated current
  EXPECT_THROW(apply(find_drive_kind("elmo_gold", ""), {64, 1, 0, false}, "here", setup), InputError);
  setup.homing_method = 35;
  EXPECT_THROW(apply(find_drive_kind("eyou", ""), {64, 1, 1, false}, "here", setup), InputError);  // has no homing
  setup.homing_method = 8;
  EXPECT_THROW(apply(find_drive_kind("epos4", ""), {64, 1, 1, false}, "here", setup), InputError);
}

// Their own EDS, DCF and ESI files, as shared/drives/objects.csv has them: as many sub-indices of 1600 as a PDO maps objects.
TEST(DriveProfileFile, MapsAsManyObjectsAsTheMakersDictionaryHasEntries) {
  std::map<std::string, double> entries;
  std::ifstream csv(LANTERNFISH_SOURCE_DIR "/shared/drives/objects.csv");
  for (std::string line; std::getline(csv, line);) {
    const std::size_t at = line.find(",1600,");
    if (at != std::string::npos && line.compare(at + 6, 2, "00") != 0) ++entries[line.substr(0, at)];
  }
  for (const auto& [name, dictionary] :
       {std::pair{"epos4", "maxon EPOS4 Compact 50/5 CAN"}, std::pair{"epos4_configured", "maxon EPOS4 Module 50/15 (as configured)"},
        std::pair{"elmo_gold", "Elmo Gold (V005)"}, std::pair{"ipos", "Technosoft iPOS (iPOS.D v1.04 rev 5)"},
        std::pair{"c5e", "Nanotec C5-E-2-09"}, std::pair{"ingenia", "Ingenia/Novanta EVE-NET-C 1.8.1"},
        std::pair{"copley", "Copley Accelnet family 2009"}, std::pair{"eyou", "Eyou joint servo V1.4"},
        std::pair{"lmdrive", "Schneider Lexium MDrive NEMA23"}}) {
    EXPECT_EQ(find_drive_kind(name, "").most_mapped, entries[dictionary]) << name;
  }
}

TEST(DriveProfileFile, ADriveThatMapsTooLittleIsRefusedWithTheNumber) {
  const auto problem = [](double most, bool feed_forward) -> std::string {
    DriveKind kind = find_drive_kind("cia402", "");
    kind.title = "a small drive";
    kind.rating = "object";
    kind.most_mapped = most;
    if (!feed_forward) kind.absences.push_back({0x60B2, 0, canopen::Substitute::no_feed_forward, "", ""});
    canopen::DriveSetup setup;
    try {
      apply(kind, {64, 0.5, 1.3, false}, "drives.elbow", setup);
    } catch (const InputError& refused) {
      return refused.what();
    }
    return "";
  };
  EXPECT_EQ(problem(3, true), "");
  EXPECT_EQ(problem(3, false), "");
  // The torque offset is not the only third object: 6041, 6064 and 6077 are what the core looks at.
  for (const bool feed_forward : {true, false})
    EXPECT_EQ(problem(2, feed_forward),
              "drives.elbow: a small drive maps 2 objects into a PDO at most ('mapping.most_objects'), and TPDO 1 takes 3");
  EXPECT_NE(problems_of(std::string(whole) + "mapping: {most_objects: 65}\n").find("mine.yaml:6: 'mapping.most_objects'"),
            std::string::npos);
}

TEST(DriveProfileFile, CodesOfALostPositionAreEmcyCodes) {
  EXPECT_EQ(problems_of(std::string(whole) + "position_lost: [\"7320\", \"FF02\"]\n"), "");
  for (const char* wrong : {"\"732\"", "\"73200\"", "\"732G\"", "\"0000\""}) {
    SCOPED_TRACE(wrong);
    EXPECT_NE(problems_of(std::string(whole) + "position_lost: [" + wrong + "]\n").find("takes EMCY codes of 4 hex digits in quotes"),
              std::string::npos);
  }
  std::string codes = "\"7320\"";
  for (std::size_t i = 1; i < canopen::DriveProfile::max_position_lost; ++i) codes += ", \"7320\"";
  EXPECT_EQ(problems_of(std::string(whole) + "position_lost: [" + codes + "]\n"), "");
  EXPECT_NE(problems_of(std::string(whole) + "position_lost: [" + codes + ", \"7320\"]\n").find("more codes than the core holds, 8"),
            std::string::npos);
}

TEST(DriveProfileFile, ErrorTextsAreTheDrivesElseTheStandards) {
  const DriveKind kind = find_drive_kind("epos4", "");
  EXPECT_EQ(kind.error_text(0x8A82), "software position limit");
  EXPECT_EQ(kind.error_text(0x8611), "following error");
  EXPECT_EQ(find_drive_kind("cia402", "").error_text(0x8130), "heartbeat lost");
}

}  // namespace
}  // namespace lf::config
