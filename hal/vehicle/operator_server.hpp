// The operator interface's socket: a Unix socket on which each line is answered by one. What a line means is not known here, but for one thing: a line that
// is a stop overtakes those before it.
//
// Anybody who can open the socket may be hostile. Therefore: each turn takes one line of each client at most; a client that sends no line, sends too long a
// one, or does not read its answers is let go; and a new client always finds room, since the one that was silent for longest makes way: one of the same
// user when he has his share, else one of the user who has most. Who is on the other end is known by the kernel's word (SO_PEERCRED).
//
// One thread owns it.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/messages/time.hpp"

namespace lf::hal {

class OperatorServer {
 public:
  // Of a line that waits for its answer.
  using Ticket = std::uint64_t;
  // Takes one line, without its newline. The answer, or nothing when reply() brings it later: the client's next line waits for that.
  using Take = std::function<std::optional<std::string>(const std::string& line, unsigned user, Ticket ticket)>;
  using IsStop = std::function<bool(std::string_view line)>;

  struct Limits {
    std::size_t clients = 32;
    std::size_t clients_a_user = 8;
    std::size_t accepted_a_turn = 8;
    std::size_t longest_line = 16384;  // bytes
    Duration idle = Duration::from_s(60);
  };

  // Who may open the socket: its group, or everyone on this machine. `group` empty: the daemon's own.
  struct Access {
    bool everyone = false;
    std::string group;
  };

  struct Stats {
    std::uint64_t lines = 0;
    std::uint64_t made_way = 0;   // clients let go for a new one
    std::uint64_t idle = 0;       // ... that asked nothing for too long
    std::uint64_t let_go = 0;     // ... that sent too long a line or did not read
    std::uint64_t overtaken = 0;  // lines that a stop of the same client overtook
  };

  OperatorServer(Take take, IsStop is_stop, const Limits& limits);
  OperatorServer(Take take, IsStop is_stop) : OperatorServer(std::move(take), std::move(is_stop), Limits()) {}
  ~OperatorServer();
  OperatorServer(const OperatorServer&) = delete;
  OperatorServer& operator=(const OperatorServer&) = delete;

  // Called with the ticket of a line whose client has hung up, or was let go, before its answer. One that has only sent its last line has not.
  void on_gone(std::function<void(Ticket)> gone) { gone_ = std::move(gone); }

  // 0 or errno; `explain` puts it in words. The folder is made if need be. A socket of this user's that nobody listens to any more is replaced; one that
  // somebody does is EADDRINUSE, and whatever else stands at the path is EEXIST and left alone.
  int open(const std::string& path, const Access& access);
  int open(const std::string& path) { return open(path, Access()); }
  static std::string explain(int error, const std::string& path);

  // One turn: waits for at most `how_long`, or until `wake` (-1: none) is readable, and takes what has come.
  void serve(Duration how_long, int wake);
  // The answer to a line that was taken before. Nothing happens when its client has gone.
  void reply(Ticket ticket, const std::string& answer);

  const Stats& stats() const { return stats_; }

 private:
  struct Client {
    int fd = -1;
    unsigned user = 0;
    Ticket waits_for = 0;  // 0: for nothing
    Time heard;            // its last line, or when it came
    std::string text;
    std::size_t searched = 0;  // of the text, for stops
  };

  void accept_new(Time now);
  bool make_room(unsigned user);
  void let_go(Client& client);
  void refuse_length(Client& client);
  void forget_gone();
  void read(Client& client, bool hung_up);
  void overtake(Client& client, Time now);
  void take_line(Client& client, Time now);
  bool cut_line(Client& client, std::string& line);
  void send_line(Client& client, const std::string& answer);
  bool has_line(const Client& client) const { return client.waits_for == 0 && client.text.find('\n') != std::string::npos; }

  Take take_;
  IsStop is_stop_;
  std::function<void(Ticket)> gone_;
  Limits limits_;
  int listener_ = -1;
  std::string path_;
  dev_t device_ = 0;
  ino_t inode_ = 0;
  std::vector<Client> clients_;
  Ticket last_ticket_ = 0;
  Stats stats_;
};

}  // namespace lf::hal
