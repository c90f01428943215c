// The operator's interface: who may do what (and the page that says so), the socket, the lock, and the service manager.
// To bring the page up to date: LANTERNFISH_UPDATE_DOCS=1 build/release/tests/test_vehicle --gtest_filter='Page.*'
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "hal/config/key_text.hpp"
#include "hal/vehicle/estop_input.hpp"
#include "hal/vehicle/instance_lock.hpp"
#include "hal/vehicle/operator_rights.hpp"
#include "hal/vehicle/service_manager.hpp"
#include "hal/vehicle/vehicle_config.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "tests/unit/vehicle/fake_linux.hpp"

namespace lf::hal {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

std::string rights_table() {
  std::ostringstream out;
  out << "| request | " << name(Role::watcher) << " | " << name(Role::pilot) << " | " << name(Role::engineer)
      << " | does | a line |\n|---|---|---|---|---|---|\n";
  for (const Right& right : operator_rights()) {
    out << "| `" << right.request << "` |";
    for (std::size_t r = 0; r < role_count; ++r) out << (static_cast<Role>(r) >= right.least ? " yes |" : " |");
    out << " " << right.does << " | `" << right.line << "` |\n";
  }
  return out.str();
}

std::string keys_table() {
  std::string out = config::markdown_head;
  VehicleConfig config;
  for (const config::Key& key : keys(config)) out += config::markdown_row(key);
  return out;
}

void expect_on_page(const std::string& mark, const std::string& drawn) {
  const std::string page = LANTERNFISH_SOURCE_DIR "/docs/operating.md";
  std::ifstream file(page);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::string begin = "<!-- " + mark + ": drawn from the code -->\n";
  const std::size_t first = text.find(begin);
  ASSERT_NE(first, std::string::npos) << page << " has no mark for the " << mark;
  const std::size_t start = first + begin.size(), stop = text.find("<!-- end -->", start);
  if (std::getenv("LANTERNFISH_UPDATE_DOCS") != nullptr) {
    text.replace(start, stop - start, drawn);
    std::ofstream(page) << text;
    return;
  }
  EXPECT_EQ(text.substr(start, stop - start), drawn) << page << " is not up to date";
}

TEST(Page, OfTheRightsIsTheTable) { expect_on_page("rights", rights_table()); }
TEST(Page, OfTheKeysIsTheTable) { expect_on_page("keys", keys_table()); }

TEST(Rights, EveryoneMayStopTheArmAndNobodyUnknownMayMoveIt) {
  EXPECT_EQ(right_of("estop")->least, Role::watcher);
  for (const char* moves : {"start", "home", "resume", "jog"}) EXPECT_GT(right_of(moves)->least, Role::watcher) << moves;
  EXPECT_EQ(right_of("format-disk"), nullptr);
}

TEST(Rights, RolesFollowTheUserAndItsGroups) {
  EXPECT_EQ(role_of_user(0, {}, {}), Role::engineer);
  EXPECT_EQ(role_of_user(geteuid(), {}, {}), Role::engineer);
  constexpr unsigned nobody = 65534;
  EXPECT_EQ(role_of_user(nobody, {}, {}), Role::watcher);
  EXPECT_EQ(role_of_user(nobody, {"nobody"}, {}), Role::pilot);
  EXPECT_EQ(role_of_user(nobody, {"@nogroup"}, {}), Role::pilot);
  EXPECT_EQ(role_of_user(nobody, {"@nogroup"}, {"nobody"}), Role::engineer);
  EXPECT_EQ(role_of_user(4'000'000, {"nobody"}, {}), Role::watcher);  // a number without a name
}

TEST(InstanceLock, OneMasterABus) {
  const TemporaryFolder folder;
  InstanceLock first, second, other;
  EXPECT_EQ(first.take(folder.path(), "can0"), "");
  EXPECT_NE(second.take(folder.path(), "can0").find("(process " + std::to_string(getpid()) + ")"), std::string::npos);
  EXPECT_EQ(other.take(folder.path(), "can1"), "");
  {
    InstanceLock gone;
    EXPECT_EQ(gone.take(folder.path(), "can2"), "");
  }
  InstanceLock after;
  EXPECT_EQ(after.take(folder.path(), "can2"), "");
  InstanceLock nowhere;
  EXPECT_NE(nowhere.take("/no/such/folder", "can0").find("lock_folder"), std::string::npos);
}

// One that root has made by hand would keep the service out.
TEST(InstanceLock, OfRootBelongsToTheFoldersOwner) {
  if (geteuid() != 0) GTEST_SKIP() << "not root";
  const TemporaryFolder folder;
  constexpr uid_t user = 4321, group = 8765;
  ASSERT_EQ(chown(folder.path().c_str(), user, group), 0);
  InstanceLock lock;
  ASSERT_EQ(lock.take(folder.path(), "can0"), "");
  struct stat file {};
  ASSERT_EQ(stat(lock.path().c_str(), &file), 0);
  EXPECT_EQ(file.st_uid, user);
  EXPECT_EQ(file.st_gid, group);
}

TEST(InstanceLock, TellsWhoHoldsItAndTakesNothing) {
  const TemporaryFolder folder;
  EXPECT_EQ(locked_by_another(folder.path(), "can0"), std::nullopt);
  EXPECT_EQ(locked_by_another("/no/such/folder", "can0"), std::nullopt);
  {
    InstanceLock daemon;
    EXPECT_EQ(daemon.take(folder.path(), "can0"), "");
    EXPECT_THAT(locked_by_another(folder.path(), "can0").value_or(""),
                HasSubstr("(process " + std::to_string(getpid()) + ") is the master of can0"));
    EXPECT_EQ(locked_by_another(folder.path(), "can1"), std::nullopt);
  }
  EXPECT_EQ(locked_by_another(folder.path(), "can0"), std::nullopt);
  InstanceLock after;
  EXPECT_EQ(after.take(folder.path(), "can0"), "");
}

TEST(EstopInput, OnlyAOneIsClosed) {
  const TemporaryFolder folder;
  EXPECT_TRUE(EstopInput().closed());
  for (const char* whole : {"1", "1\n"}) EXPECT_TRUE(EstopInput(folder.write("a", whole)).closed()) << whole;
  for (const char* broken : {"0\n", "0", "", "\n", "2", "x", "11", "12", "1023\n", "10", "1 ", " 1", "1\n\n", "1\r\n", "1.0", "1\n0"})
    EXPECT_FALSE(EstopInput(folder.write("b", broken)).closed()) << broken;
  EXPECT_FALSE(EstopInput(folder / "none").closed());
}

TEST(EstopLine, IsOpenUntilTheInputWasReadAndWhenItIsNoLonger) {
  const auto at = [](std::int64_t ms) { return Time::from_ns(ms * 1'000'000); };
  EstopLine none(false), line(true);
  EXPECT_TRUE(none.closed(at(5)));
  EXPECT_FALSE(line.closed(at(5)));
  line.tell(true, at(10));
  EXPECT_TRUE(line.closed(at(310)));
  EXPECT_FALSE(line.closed(at(311)));  // the thread that reads it hangs
  line.tell(true, at(320));
  line.tell(false, at(340));
  EXPECT_FALSE(line.closed(at(341)));
}

TEST(ServiceManager, HearsWhatIsSaid) {
  const TemporaryFolder folder;
  const std::string path = folder / "notify";
  const int fd = socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  setenv("NOTIFY_SOCKET", path.c_str(), 1);
  EXPECT_TRUE(notify_service_manager("READY=1\nSTATUS=here"));
  std::array<char, 64> text{};
  ASSERT_GT(recv(fd, text.data(), text.size(), MSG_DONTWAIT), 0);
  EXPECT_STREQ(text.data(), "READY=1\nSTATUS=here");
  close(fd);
  EXPECT_FALSE(notify_service_manager("WATCHDOG=1"));
  unsetenv("NOTIFY_SOCKET");
  EXPECT_TRUE(notify_service_manager("READY=1"));
}

TEST(ServiceManager, WantsItsWatchdogFedByThisProcessOnly) {
  unsetenv("WATCHDOG_USEC");
  EXPECT_FALSE(watchdog_interval());
  setenv("WATCHDOG_USEC", "1000000", 1);
  EXPECT_EQ(watchdog_interval()->ns(), 500'000'000);
  setenv("WATCHDOG_PID", "1", 1);
  EXPECT_FALSE(watchdog_interval());
  unsetenv("WATCHDOG_USEC");
  unsetenv("WATCHDOG_PID");
}

TEST(AnotherMaster, IsHeardByWhateverOnlyAMasterSends) {
  test::FakeLinux linux_;
  SocketCan::Config config;
  config.filters = core_filters();
  for (const std::uint32_t id : {0x080U, 0x77FU, 0x000U, 0x203U, 0x605U, 0x181U}) {
    SocketCan can(config, linux_);
    ASSERT_EQ(can.open(), port_ok);
    test::FakeLinux::Arriving frame;
    frame.frame.can_id = id;
    linux_.arriving.push_back(frame);
    linux_.polled = POLLIN;
    // A master is heard at once; that there is none takes the whole time. The time is real: long enough for a machine that stands still meanwhile.
    const bool master = id != 0x181U;
    EXPECT_EQ(hear_another_master(can, master ? Duration::from_s(60) : Duration::from_ms(20)).has_value(), master) << std::hex << id;
  }
}

}  // namespace
}  // namespace lf::hal
