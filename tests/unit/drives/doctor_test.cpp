// `lanternfishd doctor` on simulated drives: it knows them, says what differs, drafts a profile for a stranger, and changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "hal/vehicle/bus_doctor.hpp"
#include "shared/input_error.hpp"
#include "tests/unit/drives/drive_bench.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace lf::test {
namespace {

std::vector<config::DriveKind> all_kinds() {
  std::vector<config::DriveKind> kinds;
  for (const std::string& name : config::shipped_drive_kinds()) kinds.push_back(config::find_drive_kind(name, ""));
  return kinds;
}

// Runs the doctor on a bus that nobody is the master of.
std::vector<hal::FoundNode> examine(DriveBench& bench) {
  bench.run(Duration::from_ms(300));  // power and boot-up
  hal::BusDoctor doctor(1, 8, all_kinds());
  Time now = bench.now;
  std::vector<CanFrame> sent;
  for (int ms = 0; ms < 20'000 && !doctor.done(); ++ms) {
    now = now + Duration::from_ms(1);
    bench.devices.step(now, bench.joints);
    CanFrame frame;
    for (Time delivered; bench.devices.next_to_master(frame, delivered);) doctor.on_frame(frame, now);
    std::vector<CanFrame> out;
    doctor.step(now, out);
    for (const CanFrame& one : out) {
      bench.devices.master_sends(one, now);
      sent.push_back(one);
    }
  }
  EXPECT_TRUE(doctor.done());
  // SDO uploads, and aborts of those that were not answered.
  for (const CanFrame& one : sent) {
    EXPECT_TRUE(one.id > 0x600 && one.id < 0x680);
    const int command = one.data[0] >> 5;
    EXPECT_TRUE(command == 2 || command == 3 || command == 4) << command;
  }
  return doctor.nodes();
}

TEST(BusDoctor, FindsTheNodesAndTheProfileOfEachKnownDrive) {
  const std::vector<config::DriveKind> kinds = all_kinds();
  for (const char* make : {"lanternfish", "epos4", "elmo_gold", "ipos", "c5e", "lmdrive", "eyou", "copley"}) {
    SCOPED_TRACE(make);
    DriveBench bench({"", make});
    const std::vector<hal::FoundNode> nodes = examine(bench);
    ASSERT_EQ(nodes.size(), 6u);
    EXPECT_FALSE(nodes[5].drive());
    const auto fit = hal::kinds_of(nodes[2], kinds);
    ASSERT_FALSE(fit.empty());
    const config::DriveKind* kind = fit.front();
    EXPECT_EQ(kind->name, make);
    const std::vector<std::string> all = hal::differences(nodes[2], *kind);
    EXPECT_TRUE(all.empty()) << all.front();
  }
}

TEST(BusDoctor, NamesWhatDiffersFromTheProfile) {
  DriveBench bench({"", "c5e"});
  const std::vector<hal::FoundNode> nodes = examine(bench);
  config::DriveKind kind = config::find_drive_kind("c5e", "");
  kind.objects[0].value = "0x00B50000";
  kind.absences.clear();
  const std::vector<std::string> all = hal::differences(nodes.at(2), kind);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_NE(all[0].find("60A8:00 position unit holds 0xFF410000, the profile says 0x00B50000"), std::string::npos) << all[0];
  EXPECT_NE(all[1].find("6076:00 rated torque is not there"), std::string::npos) << all[1];
}

TEST(BusDoctor, SaysWhatALostSyncDoesAndTheBrakesTimes) {
  const auto text = [](const char* make) {
    DriveBench bench({"", make});
    const std::vector<hal::FoundNode> nodes = examine(bench);
    return hal::doctor_text({nodes.at(2)}, all_kinds());
  };
  const std::string c5e = text("c5e"), copley = text("copley");
  EXPECT_NE(c5e.find("  when SYNC is lost: says so in bit 8 of the statusword\n"), std::string::npos) << c5e;
  EXPECT_NE(c5e.find("  its brake: opens within 1000 ms, closes within 2000 ms\n"), std::string::npos) << c5e;
  EXPECT_NE(copley.find("  when SYNC is lost: no document says it, try it on the bench\n"), std::string::npos) << copley;
  EXPECT_NE(copley.find("  its brake: the profile states no times\n"), std::string::npos) << copley;
}

TEST(BusDoctor, DraftsAProfileThatIsReadOnceItsQuestionsAreAnswered) {
  DriveBench bench({"", "ingenia"});
  const std::vector<hal::FoundNode> nodes = examine(bench);
  ASSERT_TRUE(hal::kinds_of(nodes.at(2), all_kinds()).empty());
  std::string draft = hal::draft_profile(nodes[2]);
  EXPECT_NE(draft.find("\"1016:01\", by: node_guarding"), std::string::npos) << draft;
  const TemporaryFolder folder;
  const auto write = [&](const std::string& text) {
    std::ofstream(folder.path() / "stranger.yaml") << text;
    return (folder.path() / "stranger.yaml").string();
  };
  EXPECT_THROW(config::read_drive_kind(write(draft)), InputError) << "its questions were not asked";
  const auto answer = [&](const std::string& question, const std::string& text) {
    const std::size_t at = draft.find(question);
    ASSERT_NE(at, std::string::npos) << question;
    draft.replace(at + question.size() - 5, 5, text);
  };
  answer("units_per_count: STATE", "1");
  answer("units_per_rev_s: STATE", "1000");
  answer("units_per_rev_s2: STATE", "1000");
  answer("basis: STATE", "torque");
  answer("rating_unit_unm: STATE", "1000");
  const config::DriveKind kind = config::read_drive_kind(write(draft));
  EXPECT_TRUE(hal::differences(nodes[2], kind).empty());
}

// It said no more than that the drive agrees, whatever its factor group held.
TEST(BusDoctor, NotesUnitsThatNoObjectConfirmsWithWhatTheDriveHolds) {
  config::DriveKind unchecked = config::find_drive_kind("lmdrive", "");
  unchecked.objects.clear();
  DriveBench lmdrive({"", "lmdrive"}), copley({"", "copley"});
  const std::vector<hal::FoundNode> nodes = examine(lmdrive), others = examine(copley);
  const std::string text = hal::doctor_text({nodes.at(2)}, {unchecked});
  EXPECT_NE(text.find("agrees with its profile\n  note: its units are confirmed by no object"), std::string::npos) << text;
  EXPECT_NE(text.find("\n    - {object: \"608F:01\", type: u32, value: 0x00000FA0}\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\n    - {object: \"6092:01\", type: u32, value: 0x0000C800}\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("\"6091:01\""), std::string::npos) << "it has none\n" << text;
  const auto document = hal::doctor_json({nodes.at(2)}, {unchecked});
  EXPECT_EQ(document["nodes"][0]["units_confirmed"], false);
  EXPECT_EQ(document["nodes"][0]["unit_objects"].size(), 4u);
  EXPECT_EQ(hal::doctor_text({nodes[2]}, all_kinds()).find("confirmed by no object"), std::string::npos);
  EXPECT_EQ(hal::doctor_json({nodes[2]}, all_kinds())["nodes"][0]["units_confirmed"], true);
  const std::string none = hal::doctor_text({others.at(2)}, all_kinds());
  EXPECT_NE(none.find("it has none of 608F, 6091, 6092, 60A8, 60A9. Measure a short jog"), std::string::npos) << none;
}

// It agreed with the profile that fits the drive, and the boot then failed by the one that the machine's file names.
TEST(BusDoctor, HoldsADriveAgainstTheProfileThatItsJointIsConfiguredWith) {
  DriveBench bench({"", "lmdrive"});
  const std::vector<hal::FoundNode> nodes = examine(bench);
  const auto said = [&](const char* profile, std::uint8_t node) {
    return hal::doctor_text({nodes.at(2)}, all_kinds(), {{node, {"elbow", config::find_drive_kind(profile, "")}}});
  };
  const std::string right = said("lmdrive", 3), wrong = said("epos4", 3), absent = said("lmdrive", 9);
  EXPECT_NE(right.find("elbow, configured as lmdrive"), std::string::npos) << right;
  EXPECT_NE(right.find("agrees with its profile"), std::string::npos) << right;
  EXPECT_NE(wrong.find("1018:01"), std::string::npos) << wrong;
  EXPECT_NE(wrong.find("holds 0x0800005A, the profile says 0x000000FB"), std::string::npos) << wrong;
  EXPECT_NE(wrong.find("it may be: lmdrive"), std::string::npos) << wrong;
  EXPECT_NE(absent.find("node 9: nobody answers, and the elbow is configured there"), std::string::npos) << absent;
}

// What a profile wants checked was read only where the boot reads it, too; one of the vendor's other drives was taken for the first.
TEST(BusDoctor, ReadsWhatAProfileWantsCheckedAndNamesAllThatFit) {
  DriveBench bench({"", "ipos"});
  const std::vector<hal::FoundNode> nodes = examine(bench);
  for (const config::ProfileObject& object : config::find_drive_kind("ipos", "").objects) {
    if (object.writes) continue;
    EXPECT_NE(nodes.at(2).find(object.index, object.sub), nullptr) << config::object_text(object.index, object.sub);
  }
  const std::string text = hal::doctor_text({nodes.at(2)}, all_kinds());
  EXPECT_NE(text.find("it may as well be: ipos4808"), std::string::npos) << text;
}

// The document says what the text says, and whether a script may go on.
TEST(BusDoctor, TheDocumentAgreesWhenEveryConfiguredDriveDoes) {
  DriveBench bench({"", "lmdrive"});
  const std::vector<hal::FoundNode> nodes = examine(bench);
  const auto document = [&](const char* profile, std::uint8_t node) {
    return hal::doctor_json(nodes, all_kinds(), {{node, {"elbow", config::find_drive_kind(profile, "")}}});
  };
  const auto right = document("lmdrive", 3);
  EXPECT_EQ(right["agrees"], true) << right.dump(1);
  ASSERT_EQ(right["nodes"].size(), 6u);
  EXPECT_EQ(right["nodes"][2]["joint"], "elbow");
  EXPECT_EQ(right["nodes"][2]["profile"], "lmdrive");
  EXPECT_EQ(right["nodes"][2]["vendor"], 0x0800005A);
  EXPECT_TRUE(right["nodes"][2]["differences"].empty());
  EXPECT_EQ(right["nodes"][5]["drive"], false);
  EXPECT_FALSE(right["nodes"][5].contains("differences"));
  const auto wrong = document("epos4", 3), absent = document("lmdrive", 9), output_node = document("lmdrive", 6);
  EXPECT_EQ(wrong["agrees"], false);
  EXPECT_FALSE(wrong["nodes"][2]["differences"].empty());
  EXPECT_EQ(absent["agrees"], false);
  EXPECT_EQ(absent["missing"][0]["node"], 9);
  EXPECT_EQ(absent["missing"][0]["joint"], "elbow");
  EXPECT_EQ(output_node["agrees"], false) << "no drive at all";
  EXPECT_EQ(hal::doctor_json({}, {})["agrees"], false) << "nobody answers";
}

TEST(BusDoctor, AnEmptyBusIsToldAsOne) { EXPECT_NE(hal::doctor_text({}, {}).find("nobody answers"), std::string::npos); }

}  // namespace
}  // namespace lf::test
