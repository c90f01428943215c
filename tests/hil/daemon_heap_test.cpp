// The daemon's memory does not grow under hostile clients, over an hour where LANTERNFISH_HOSTILE_S says so (tests/nightly_shards).
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tests/hil/assembled_daemon.hpp"

namespace lf::test {
namespace {

constexpr std::uint64_t seed = 20261123;
constexpr double quick_s = 8;
// The log's queue and what is just being answered differ by some 110 kB from one moment to the next: 30 s of attacks leave no more than 8 s do.
constexpr double growth_kb = 256;

double wanted_s() {
  const char* set = std::getenv("LANTERNFISH_HOSTILE_S");
  return set != nullptr ? std::atof(set) : quick_s;
}

// A connection that is closed at its end; what cannot be sent is not.
class Client {
 public:
  explicit Client(const std::string& path) : fd_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    const timeval patience{0, 200'000};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) closed_ = true;
  }
  ~Client() { close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  void send(const std::string& text) { closed_ = closed_ || ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL) < 0; }
  void read() {
    char answer[4096];
    closed_ = closed_ || recv(fd_, answer, sizeof answer, 0) <= 0;
  }
  bool closed() const { return closed_; }

 private:
  int fd_;
  bool closed_ = false;
};

// Clients that flood, never read, send garbage, never end a line, idle, and come and go.
class Hostile {
 public:
  explicit Hostile(const std::string& path) {
    for (std::uint64_t i = 0; i < 6; ++i) {
      threads_.emplace_back([this, path, i] {
        std::mt19937_64 random(seed + i);
        while (!over_) {
          attack(i, path, random);
          ++attacks_;
        }
      });
    }
  }
  ~Hostile() {
    over_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  std::uint64_t attacks() const { return attacks_; }

 private:
  void attack(std::uint64_t kind, const std::string& path, std::mt19937_64& random) const {
    const std::string status = "{\"do\":\"status\"}\n";
    if (kind == 0) {
      Client flood(path);
      for (int i = 0; i < 100 && !flood.closed(); ++i) flood.send(status);
      while (!flood.closed() && !over_) flood.read();
    } else if (kind == 1) {
      Client deaf(path);
      for (int i = 0; i < 200 && !deaf.closed() && !over_; ++i) deaf.send(status);
    } else if (kind == 2) {
      std::string bytes;
      for (int i = 0; i < 300; ++i) bytes += static_cast<char>(random() & 0xFF);
      Client garbage(path);
      garbage.send((random() & 1) != 0 ? bytes + "\n" : R"({"do":"task","tasks":)" + std::string(2000, '[') + "\n");
      garbage.read();
    } else if (kind == 3) {
      Client endless(path);
      for (int i = 0; i < 100 && !endless.closed() && !over_; ++i) endless.send(std::string(4096, 'x'));
    } else if (kind == 4) {
      std::vector<std::unique_ptr<Client>> idle;
      for (int i = 0; i < 20; ++i) idle.push_back(std::make_unique<Client>(path));
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
    } else {
      for (int i = 0; i < 50; ++i) Client come_and_go(path);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  std::atomic<bool> over_{false};
  std::atomic<std::uint64_t> attacks_{0};
  std::vector<std::thread> threads_;
};

class DaemonUnderAttack : public AssembledDaemon {
 protected:
  // What is in use when nobody has attacked for a second, kB. `attacks` were made before.
  double used_after_kb(double seconds, std::uint64_t& attacks) {
    {
      Hostile clients(folder / "operator.sock");
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
      attacks += clients.attacks();
    }
    std::this_thread::sleep_for(std::chrono::seconds(1));
    return static_cast<double>(mallinfo2().uordblks + mallinfo2().hblkhd) / 1024;
  }
};

TEST_F(DaemonUnderAttack, UsesNoMoreMemoryInTheEnd) {
  const double seconds = wanted_s();
  begin();
  order("home");
  ASSERT_TRUE(wait_standing("ready"));
  std::uint64_t attacks = 0;
  const double early_kb = used_after_kb(0.2 * seconds, attacks);
  const double late_kb = used_after_kb(0.8 * seconds, attacks);
  std::printf("%.0f s, seed %llu, %llu attacks: %.0f kB early, %.0f kB late\n", seconds, static_cast<unsigned long long>(seed),
              static_cast<unsigned long long>(attacks), early_kb, late_kb);
  EXPECT_GT(attacks, 10 * seconds);
  EXPECT_LE(late_kb - early_kb, growth_kb);
  // It is the one that was attacked, and still obeys.
  EXPECT_EQ(ask("status")["ok"], true);
  order("estop");
  EXPECT_TRUE(wait_standing("ended", 5));
}

}  // namespace
}  // namespace lf::test
