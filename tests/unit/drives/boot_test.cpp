// The boot on a strict drive made of each public dictionary: it passes, or ends before there is power and says which object is in the way.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "firmware/canopen/boot_plan.hpp"
#include "hal/config/drive_kind.hpp"
#include "host_sim/devices/drive/drive_habits.hpp"
#include "tests/unit/drives/drive_bench.hpp"

namespace lf::test {
namespace {

using canopen::BootFailure;

struct Expected {
  const char* dictionary;
  const char* profile;  // of the core
  const char* object;   // in the way; empty: it boots
};

// Drives without a profile of their own are tried with the standard's.
const Expected all_makes[] = {
    {"epos4", "epos4", ""},
    {"epos4_configured", "epos4_configured", ""},
    {"elmo_gold", "elmo_gold", ""},
    {"elmo_gold_configured", "elmo_gold_configured", ""},
    {"ipos", "ipos", ""},
    {"c5e", "c5e", ""},
    {"ingenia", "ingenia", ""},
    {"lmdrive", "lmdrive", ""},
    {"eyou", "eyou", ""},
    {"copley", "copley", ""},
    {"elmo_simpliq", "cia402_rated", "1400:01"},
    {"epos2", "cia402_rated", "60C2:01"},
    {"isd860", "cia402_rated", "1016:01"},
    {"faulhaber", "cia402_rated", "60C2:02"},
    {"prbt", "cia402_rated", "6007:00"},
    {"dryve", "cia402_rated", "6007:00"},
    {"tmcm6214", "cia402_rated", "6007:00"},
    {"tmcm1270", "cia402_rated", "6007:00"},
    {"roboteq", "cia402_rated", "60C2:02"},
};

std::string table_row(const Expected& make, const DriveBench& bench, bool booted) {
  const devices::DriveHabit* habit = devices::find_habit(make.dictionary);
  std::string row = std::string("| ") + habit->dictionary + " | `" + make.profile + "` | ";
  if (!booted) {
    const std::string sentence = bench.sentence();
    return row + "no: " + sentence.substr(sentence.find("): ") + 3) + " |";
  }
  row += "yes";
  const config::DriveKind kind = config::find_drive_kind(make.profile, "");
  std::string list;
  for (const config::ProfileAbsence& absence : kind.absences)
    list += (list.empty() ? "; " : ", ") + config::object_text(absence.index, absence.sub) + ": " + canopen::name(absence.by);
  return row + list + " |";
}

TEST(DriveBoot, EachDictionaryBootsOrEndsBeforeThereIsPowerWithTheObjectAndWhatToDo) {
  std::ifstream file(std::string(LANTERNFISH_SOURCE_DIR) + "/docs/canopen.md");
  const std::string docs((std::istreambuf_iterator<char>(file)), {});
  ASSERT_FALSE(docs.empty());
  ASSERT_EQ(std::size(all_makes), devices::drive_habits().size());
  std::string table;
  for (const Expected& make : all_makes) {
    SCOPED_TRACE(make.dictionary);
    DriveBench bench({make.profile, make.dictionary});
    const bool booted = bench.boot();
    EXPECT_EQ(booted, make.object[0] == '\0') << bench.sentence();
    EXPECT_FALSE(bench.powered_before_done);
    if (!booted) {
      EXPECT_NE(bench.sentence().find(make.object), std::string::npos) << bench.sentence();
      EXPECT_NE(bench.sentence().find(". "), std::string::npos) << "it does not say what to do: " << bench.sentence();
    }
    const std::string row = table_row(make, bench, booted);
    table += row + "\n";
    EXPECT_NE(docs.find(row), std::string::npos) << "docs/canopen.md lacks: " << row;
  }
  if (HasFailure()) std::printf("%s", table.c_str());
}

TEST(DriveBoot, WithoutAProfileTheDeliveredDrivesAreRefused) {
  struct Case {
    const char* make;
    const char* reason;
  };
  for (const Case& c :
       {Case{"epos4", "6076:00 rated torque is 41000, and 41 by the arm's description"}, Case{"elmo_gold", "6076:00 rated torque is 0"},
        Case{"ipos", "6076:00 rated torque does not exist"}, Case{"c5e", "6076:00 rated torque does not exist"},
        Case{"ingenia", "6076:00 rated torque is 1000, and 41 by the arm's description"},
        Case{"lmdrive", "6076:00 rated torque does not exist"}, Case{"eyou", "6076:00 rated torque does not exist"},
        Case{"copley", "1016:01 consumer heartbeat time does not exist"}}) {
    DriveBench bench({"cia402", c.make});
    EXPECT_FALSE(bench.boot()) << c.make;
    EXPECT_NE(bench.sentence().find(c.reason), std::string::npos) << c.make << ": " << bench.sentence();
  }
}

// 1018 is told as it stands in the profile, in hex. A drive of a profile of one's own answers with that profile's identity.
TEST(DriveBoot, ADriveIsKnownByTheIdentityThatItIsConfiguredWith) {
  for (const char* make : {"epos4", "lanternfish"}) {
    const auto booted = [&](std::uint32_t product, bool wrong) {
      DriveBench bench({make, make}, [&](canopen::NetworkConfig& config, devices::DevicesConfig& devices) {
        config.drives[2].identity = {0x00001234, 0x00005678};
        devices.drives[2].vendor = 0x00001234;
        devices.drives[2].product = product;
        if (wrong) devices.faults.push_back({0, devices::DeviceFaultKind::wrong_identity, devices.drives[2].node});
      });
      (void)bench.boot();
      return bench.sentence();
    };
    EXPECT_EQ(booted(0x5678, false), "") << make;
    EXPECT_NE(booted(0x5679, false).find("(holds 0x00005679, has to hold 0x00005678)"), std::string::npos) << booted(0x5679, false);
    EXPECT_NE(booted(0x5678, true).find("1018:02"), std::string::npos) << make;
  }
}

// It has the object, and takes another value: "absent" in its profile ended at the same sentence.
TEST(DriveBoot, AnOptionThatTheDriveDoesNotTakeIsToldWithTheKeyThatStatesIt) {
  const auto said = [](const std::function<void(canopen::DriveSetup&)>& change) {
    DriveBench bench({"", "epos4"}, [&](canopen::NetworkConfig& config, devices::DevicesConfig&) { change(config.drives[2]); });
    EXPECT_FALSE(bench.boot());
    return bench.sentence();
  };
  EXPECT_NE(said([](canopen::DriveSetup& drive) { drive.abort_option = 1; }).find("'options.abort_fallback'"), std::string::npos);
  EXPECT_NE(said([](canopen::DriveSetup& drive) { drive.quick_stop_option = 2; }).find("'options.quick_stop_fallback'"), std::string::npos);
}

TEST(DriveBoot, ARatedTorqueOfZeroIsRefusedUnlessItIsStated) {
  const auto zero = [](canopen::NetworkConfig&, devices::DevicesConfig& devices) {
    devices.drives[2].rated_torque_nm = 1e-9;  // an EPOS4 whose motor data nobody entered computes 0
    devices.drives[2].peak_torque_nm = 2e-8;
  };
  DriveBench bench({"", "epos4"}, zero);
  EXPECT_FALSE(bench.boot());
  EXPECT_EQ(bench.network.boot().nodes[2].failure, BootFailure::no_rating);
  EXPECT_NE(bench.sentence().find("6076:00 rated torque is 0"), std::string::npos) << bench.sentence();
}

// EPOS4's rated torque read as milli newton metres is a thousand times too big.
TEST(DriveBoot, ARatedTorqueInTheWrongUnitIsFoundByTheStatedOne) {
  DriveBench bench({"", "epos4"}, [](canopen::NetworkConfig& config, devices::DevicesConfig& devices) {
    devices.drives[2].rated_torque_nm = 0.5;
    devices.drives[2].peak_torque_nm = 1;
    config.drives[2].profile.rated_torque_unm = 500'000;
    config.drives[2].profile.rated_torque_unit_unm = 1000;
  });
  EXPECT_FALSE(bench.boot());
  EXPECT_EQ(bench.network.boot().nodes[2].failure, BootFailure::wrong_rating);
}

// The motor of another rating, said by the drive: it pushes the joint no harder.
TEST(DriveBoot, ADriveOfTwiceTheRatingPushesAsHardAsTheDescribedOne) {
  const auto limit_nm = [](double rating) {
    DriveBench bench({}, [&](canopen::NetworkConfig&, devices::DevicesConfig& devices) {
      devices.drives[2].rated_torque_nm *= rating;
      devices.drives[2].peak_torque_nm *= rating;
    });
    EXPECT_TRUE(bench.boot()) << bench.sentence();
    return bench.devices.drives()[2].torque_limit_nm;
  };
  const double described_nm = limit_nm(1);
  EXPECT_GT(described_nm, 0);
  EXPECT_NEAR(limit_nm(2), described_nm, 0.003 * described_nm) << "a thousandth of the rating";
}

TEST(DriveBoot, ADriveOfFourTimesTheRatingIsAnotherMotor) {
  DriveBench bench({"", "epos4"}, [](canopen::NetworkConfig&, devices::DevicesConfig& devices) {
    devices.drives[2].rated_torque_nm *= 4;
    devices.drives[2].peak_torque_nm *= 4;
  });
  EXPECT_FALSE(bench.boot());
  EXPECT_EQ(bench.network.boot().nodes[2].failure, BootFailure::other_motor);
  EXPECT_NE(bench.sentence().find("by the arm's description: another motor, or another unit. State"), std::string::npos)
      << bench.sentence();
}

TEST(DriveBoot, AFactorGroupThatIsNotTheProfilesIsRefused) {
  DriveBench bench({"", "c5e"}, [](canopen::NetworkConfig& config, devices::DevicesConfig&) {
    for (canopen::BootStep& step : config.drives[2].profile.objects) {
      if (step.index == 0x60A8) step.literal = 0x00B50000;
    }
  });
  EXPECT_FALSE(bench.boot());
  EXPECT_EQ(bench.network.boot().nodes[2].failure, BootFailure::wrong_setting);
  EXPECT_NE(bench.sentence().find("60A8:00 position unit has another value"), std::string::npos) << bench.sentence();
}

// The number goes over the bus in the drive's own unit.
TEST(DriveBoot, LimitsAreWrittenInTheDrivesOwnUnits) {
  struct Case {
    const char* make;
    double position_per_count, speed_per_count_s;
  };
  // 64 counts a revolution: rpm are 60/64 a count/s, tenths of a degree 3600/64 a count.
  for (const Case& c :
       {Case{"epos4", 1, 60.0 / 64}, Case{"elmo_gold", 1, 1}, Case{"c5e", 3600.0 / 64, 60.0 / 64}, Case{"eyou", 1024, 1024}}) {
    SCOPED_TRACE(c.make);
    DriveBench bench({"", c.make});
    const canopen::DriveSetup& drive = bench.config.drives[2];
    const canopen::BootContext context{&bench.config, &drive, drive.node};
    std::map<std::uint16_t, std::uint32_t> written;
    for (std::size_t i = 0; i < canopen::boot_step_count(context); ++i) {
      const canopen::BootStep step = canopen::boot_step(i, context);
      if (const auto value = canopen::boot_value(step, context); value && step.sub != 1) written[step.index] = *value;
    }
    EXPECT_NEAR(written.at(0x6065), c.position_per_count * drive.following_window_counts, 1);
    EXPECT_NEAR(written.at(0x607F), c.speed_per_count_s * drive.max_speed_counts_s, 1);
    EXPECT_NEAR(written.at(0x6085), c.speed_per_count_s * drive.quick_stop_counts_s2, 1);
    EXPECT_NEAR(static_cast<std::int32_t>(written.at(0x607D)), c.position_per_count * (drive.max_counts + drive.drive_margin_counts), 1);
  }
}

TEST(DriveBoot, OnlyWhatDiffersIsWritten) {
  DriveBench bench({"", "elmo_gold"});
  std::size_t first = 0, second = 0;
  std::size_t* count = &first;
  bench.devices.set_tap([&count](const devices::BusRecord& record) {
    if (record.frame.id == 0x603 && (record.frame.data[0] >> 5) == 1) ++*count;
  });
  ASSERT_TRUE(bench.boot()) << bench.sentence();
  EXPECT_GT(first, 15u);
  // Reset communication keeps the objects of the drive's profile, and takes the mapping back.
  count = &second;
  bench.network.start_boot(bench.now);
  ASSERT_TRUE(bench.run_until([&] { return bench.network.operational(); }, Duration::from_s(5)));
  EXPECT_LT(second, first);
  EXPECT_GT(second, 0u);
}

}  // namespace
}  // namespace lf::test
