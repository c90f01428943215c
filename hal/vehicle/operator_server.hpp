// The operator interface: a Unix socket on which each line is a JSON object, each answered by one. Who is on the other end is known by the kernel's word
// (SO_PEERCRED), not by his own.
//
// Served by one thread that calls `serve`. A client that sends no line, or too long a one, or does not read, holds up nobody: it is let go.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hal/vehicle/operator_rights.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

class OperatorServer {
 public:
  using RoleOf = std::function<Role(unsigned user)>;
  // One line in, one line out, neither with its newline.
  using Answer = std::function<std::string(const std::string& line, Role role)>;

  OperatorServer(RoleOf role_of, Answer answer);
  ~OperatorServer();
  OperatorServer(const OperatorServer&) = delete;
  OperatorServer& operator=(const OperatorServer&) = delete;

  // 0 or errno. The folder is made if need be; a socket nobody listens to any more is replaced, one that somebody does is EADDRINUSE.
  int open(const std::string& path);
  // Answers what comes within `how_long`. Returns early when `wake` is readable (-1: none).
  void serve(Duration how_long, int wake);

 private:
  struct Client {
    int fd = -1;
    Role role = Role::watcher;
    std::string text;
  };

  void welcome();
  bool listen_to(Client& client);  // false: let go

  RoleOf role_of_;
  Answer answer_;
  int listener_ = -1;
  std::string path_;
  std::vector<Client> clients_;
};

}  // namespace lf::hal
