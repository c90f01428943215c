#include "hal/vehicle/operator_server.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <utility>

namespace lf::hal {

namespace {

constexpr std::size_t most_clients = 16;
constexpr std::size_t longest_line = 16384;

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy_n(path.begin(), std::min(path.size(), sizeof address.sun_path - 1), address.sun_path);
  return address;
}

bool somebody_listens(const std::string& path) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_un address = address_of(path);
  const bool answered = connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(fd);
  return answered;
}

}  // namespace

OperatorServer::OperatorServer(RoleOf role_of, Answer answer) : role_of_(std::move(role_of)), answer_(std::move(answer)) {}

OperatorServer::~OperatorServer() {
  for (const Client& client : clients_) close(client.fd);
  if (listener_ < 0) return;
  close(listener_);
  unlink(path_.c_str());
}

int OperatorServer::open(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, ignored);
  if (somebody_listens(path)) return EADDRINUSE;
  unlink(path.c_str());
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return errno;
  const sockaddr_un address = address_of(path);
  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || listen(fd, 8) != 0) {
    const int error = errno;
    close(fd);
    return error;
  }
  chmod(path.c_str(), 0666);  // what each user may do is decided by who he is
  listener_ = fd;
  path_ = path;
  return 0;
}

void OperatorServer::welcome() {
  const int fd = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (fd < 0) return;
  ucred peer{};
  socklen_t bytes = sizeof peer;
  if (clients_.size() >= most_clients || getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &bytes) != 0) {
    close(fd);
    return;
  }
  clients_.push_back({fd, role_of_(peer.uid), {}});
}

bool OperatorServer::listen_to(Client& client) {
  std::array<char, 4096> buffer{};
  const ssize_t bytes = recv(client.fd, buffer.data(), buffer.size(), 0);
  if (bytes == 0 || (bytes < 0 && errno != EAGAIN && errno != EINTR)) return false;
  if (bytes > 0) client.text.append(buffer.data(), static_cast<std::size_t>(bytes));
  for (std::size_t end = client.text.find('\n'); end != std::string::npos; end = client.text.find('\n')) {
    const std::string line = client.text.substr(0, end);
    client.text.erase(0, end + 1);
    const std::string answer = answer_(line, client.role) + "\n";
    if (send(client.fd, answer.data(), answer.size(), MSG_NOSIGNAL | MSG_DONTWAIT) != static_cast<ssize_t>(answer.size())) return false;
  }
  return client.text.size() <= longest_line;
}

void OperatorServer::serve(Duration how_long, int wake) {
  std::vector<pollfd> polled{{wake, POLLIN, 0}, {listener_, POLLIN, 0}};
  for (const Client& client : clients_) polled.push_back({client.fd, POLLIN, 0});
  if (poll(polled.data(), polled.size(), static_cast<int>(how_long.ns() / 1'000'000)) <= 0) return;
  for (std::size_t i = clients_.size(); i-- > 0;) {
    if (polled[i + 2].revents == 0 || listen_to(clients_[i])) continue;
    close(clients_[i].fd);
    clients_.erase(clients_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  if (polled[1].revents != 0) welcome();
}

}  // namespace lf::hal
