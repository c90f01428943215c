// The operator interface's socket under clients that are slow, silent, many or hostile.
#include "hal/vehicle/operator_server.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <map>
#include <memory>
#include <vector>

#include "tests/unit/temporary_folder.hpp"

namespace lf::hal {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  return address;
}

class Client {
 public:
  explicit Client(const std::string& path) : fd_(socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0)) {
    const sockaddr_un address = address_of(path);
    connected = connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~Client() { close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  void write_no_more() const { shutdown(fd_, SHUT_WR); }
  bool say(const std::string& text) const { return send(fd_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size()); }
  // Lines that have come; the last one is "gone" when the server let go.
  std::vector<std::string> hear() {
    char buffer[65536];
    ssize_t bytes = 0;
    while ((bytes = recv(fd_, buffer, sizeof buffer, 0)) > 0) text_.append(buffer, static_cast<std::size_t>(bytes));
    const bool gone = bytes == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
    std::vector<std::string> lines;
    for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
      lines.push_back(text_.substr(0, end));
      text_.erase(0, end + 1);
    }
    if (gone) lines.emplace_back("gone");
    return lines;
  }
  bool connected = false;

 private:
  int fd_;
  std::string text_;
};

// Answers "LINE!" at once; lines that begin with "later" by hand.
class Server : public testing::Test {
 protected:
  void open(OperatorServer::Limits limits = {}) {
    server = std::make_unique<OperatorServer>(
        [this](const std::string& line, unsigned, OperatorServer::Ticket ticket) -> std::optional<std::string> {
          taken.push_back(line);
          if (!line.starts_with("later")) return line + "!";
          owed = ticket;
          return std::nullopt;
        },
        [](std::string_view line) { return line == "stop"; }, limits);
    ASSERT_EQ(server->open(path), 0);
  }
  void turn(int n = 1) {
    for (int i = 0; i < n; ++i) server->serve(Duration::from_ms(1), -1);
  }

  TemporaryFolder folder;
  std::string path = folder / "run/operator.sock";
  std::unique_ptr<OperatorServer> server;
  std::vector<std::string> taken;
  OperatorServer::Ticket owed = 0;
};

TEST_F(Server, AnswersEveryLineOfEveryClientInOrder) {
  open();
  Client one(path), two(path);
  EXPECT_TRUE(one.say("a\nb\nc\n"));
  EXPECT_TRUE(two.say("d\n"));
  turn(6);
  EXPECT_THAT(one.hear(), ElementsAre("a!", "b!", "c!"));
  EXPECT_THAT(two.hear(), ElementsAre("d!"));
}

TEST_F(Server, TellsOfAClientThatHangsUpBeforeItsAnswer) {
  open();
  std::vector<OperatorServer::Ticket> gone;
  server->on_gone([&](OperatorServer::Ticket ticket) { gone.push_back(ticket); });
  {
    Client leaves(path);
    turn();
    EXPECT_TRUE(leaves.say("now\nlater\n"));
    turn(4);
    ASSERT_NE(owed, 0u);
    EXPECT_THAT(gone, ElementsAre());
  }
  turn(2);
  EXPECT_THAT(gone, ElementsAre(owed));
  Client writes_no_more(path);
  EXPECT_TRUE(writes_no_more.say("later\n"));
  writes_no_more.write_no_more();
  turn(4);
  EXPECT_EQ(gone.size(), 1u) << "it may still read";
  server.reset();
}

TEST_F(Server, TakesOneLineOfAClientATurn) {
  open();
  Client pipelining(path), other(path);
  std::string many;
  for (int i = 0; i < 270; ++i) many += "order\n";
  turn();
  EXPECT_TRUE(pipelining.say(many));
  EXPECT_TRUE(other.say("mine\n"));
  turn();
  EXPECT_EQ(taken.size(), 2u);
  EXPECT_THAT(other.hear(), ElementsAre("mine!"));
}

TEST_F(Server, ALineWaitsForTheAnswerOfTheOneBefore) {
  open();
  Client client(path);
  EXPECT_TRUE(client.say("later\nnext\n"));
  turn(5);
  EXPECT_THAT(taken, ElementsAre("later"));
  server->reply(owed, "done");
  turn(2);
  EXPECT_THAT(client.hear(), ElementsAre("done", "next!"));
}

TEST_F(Server, AStopOvertakesWhatStandsBeforeIt) {
  open();
  Client client(path);
  EXPECT_TRUE(client.say("later\n"));
  turn(3);
  EXPECT_TRUE(client.say("start\nhome\nstop\nafter\n"));
  turn(5);
  EXPECT_THAT(taken, ElementsAre("later", "stop", "after"));
  const std::vector<std::string> lines = client.hear();
  ASSERT_EQ(lines.size(), 5u);
  for (int i = 0; i < 3; ++i) EXPECT_THAT(lines[static_cast<std::size_t>(i)], testing::HasSubstr("emergency stop came behind"));
  EXPECT_EQ(lines[3], "stop!");
  EXPECT_EQ(lines[4], "after!");
  server->reply(owed, "too late");  // its client has been answered
  EXPECT_TRUE(client.hear().empty());
}

// Sixteen silent clients kept everyone out, the emergency stop included.
TEST_F(Server, SilentClientsKeepNobodyOut) {
  open();
  std::vector<std::unique_ptr<Client>> silent;
  for (int i = 0; i < 40; ++i) {
    silent.push_back(std::make_unique<Client>(path));
    EXPECT_TRUE(silent.back()->connected);
    turn();
  }
  Client late(path);
  EXPECT_TRUE(late.say("stop\n"));
  turn(2);
  EXPECT_THAT(late.hear(), ElementsAre("stop!"));
  EXPECT_GT(server->stats().made_way, 30u);
  EXPECT_THAT(silent.front()->hear(), ElementsAre("gone"));
}

TEST_F(Server, WhoIsHeardOftenStaysWhenSilentOnesMakeWay) {
  open();
  Client talking(path);
  std::vector<std::unique_ptr<Client>> silent;
  for (int i = 0; i < 40; ++i) {
    silent.push_back(std::make_unique<Client>(path));
    EXPECT_TRUE(talking.say("x\n"));
    turn(2);
    EXPECT_THAT(talking.hear(), ElementsAre("x!")) << i;
  }
}

TEST_F(Server, LetsGoOfWhoIsSilentForTooLong) {
  OperatorServer::Limits limits;
  limits.idle = Duration::from_ms(20);
  open(limits);
  Client silent(path);
  turn(2);
  EXPECT_TRUE(silent.hear().empty());
  usleep(30'000);
  turn();
  EXPECT_THAT(silent.hear(), ElementsAre("gone"));
  EXPECT_EQ(server->stats().idle, 1u);
}

TEST_F(Server, LetsGoOfWhoSendsNoEndOfLine) {
  open();
  Client endless(path);
  // A long line is answered, so it is not the length of what comes at once that ends the connection.
  const std::string longest(16'000, 'x');
  turn();
  EXPECT_TRUE(endless.say(longest + "\n"));
  turn(6);
  EXPECT_THAT(endless.hear(), ElementsAre(longest + "!"));
  bool sent = true;
  int taken_kb = 0;
  for (; taken_kb < 4096 && sent; taken_kb += 4) {
    sent = endless.say(std::string(4096, 'x'));
    turn();
  }
  EXPECT_FALSE(sent) << "4 MB without a newline are still taken";
  EXPECT_LT(taken_kb, 1000) << "a longest line and what the kernel keeps of a socket";
  EXPECT_EQ(server->stats().let_go, 1u);
}

// The connection ended without a word.
TEST_F(Server, SaysHowLongALineMayBeBeforeItLetsGo) {
  OperatorServer::Limits limits;
  limits.longest_line = 1000;
  open(limits);
  Client endless(path);
  turn();
  EXPECT_TRUE(endless.say(std::string(1001, 'x')));
  turn();
  EXPECT_THAT(endless.hear(), ElementsAre(R"({"ok":false,"why":"a line has at most 1000 bytes"})", "gone"));
}

TEST_F(Server, LetsGoOfWhoDoesNotRead) {
  open();
  Client deaf(path);
  for (int i = 0; i < 3000 && server->stats().let_go == 0; ++i) {
    (void)deaf.say(std::string(1000, 'x') + "\n");
    turn();
  }
  EXPECT_EQ(server->stats().let_go, 1u);
}

TEST_F(Server, IsItsGroupsOnlyUnlessItIsSaidToBeEveryones) {
  open();
  struct stat made {};
  ASSERT_EQ(stat(path.c_str(), &made), 0);
  EXPECT_EQ(made.st_mode & 0777U, 0660U);
  const std::string other = folder / "other.sock";
  const auto make = [&](const OperatorServer::Access& access) {
    OperatorServer second([](const std::string&, unsigned, OperatorServer::Ticket) { return std::optional<std::string>(""); },
                          [](std::string_view) { return false; });
    const int error = second.open(other, access);
    if (error == 0) {
      EXPECT_EQ(stat(other.c_str(), &made), 0);
    }
    return error;
  };
  EXPECT_EQ(make({.everyone = true, .group = ""}), 0);
  EXPECT_EQ(made.st_mode & 0777U, 0666U);
  EXPECT_EQ(make({.everyone = false, .group = "no-such-group"}), ENOENT);
  EXPECT_NE(access(other.c_str(), F_OK), 0);  // nothing is left of it
}

TEST_F(Server, ReplacesADeadSocketAndNothingElse) {
  open();
  OperatorServer second([](const std::string&, unsigned, OperatorServer::Ticket) { return std::optional<std::string>(""); },
                        [](std::string_view) { return false; });
  EXPECT_EQ(second.open(path), EADDRINUSE);
  const std::string file = folder.write("notes.txt", "mine");
  EXPECT_EQ(second.open(file), EEXIST);
  EXPECT_EQ(folder.read("notes.txt"), "mine");
  const std::string other_name = folder / "link";
  ASSERT_EQ(symlink(file.c_str(), other_name.c_str()), 0);
  EXPECT_EQ(second.open(other_name), EEXIST);
  EXPECT_EQ(second.open(folder / std::string(120, 'x')), ENAMETOOLONG);
  const std::string dead = folder / "dead.sock";
  const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
  const sockaddr_un address = address_of(dead);
  ASSERT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ::close(fd);
  EXPECT_EQ(second.open(dead), 0);
}

TEST_F(Server, LeavesASocketAloneThatIsNoLongerItsOwn) {
  open();
  ASSERT_EQ(unlink(path.c_str()), 0);
  folder.write("run/operator.sock", "somebody else's");
  server.reset();
  EXPECT_EQ(folder.read("run/operator.sock"), "somebody else's");
}

}  // namespace
}  // namespace lf::hal
