#include "hal/vehicle/operator_server.hpp"

#include <grp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <utility>

#include "hal/vehicle/tick_clock.hpp"

namespace lf::hal {

namespace {

// Connections that the kernel keeps until they are accepted.
constexpr int backlog = 64;
constexpr const char* overtaken = R"({"ok":false,"why":"an emergency stop came behind it"})";

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy_n(path.begin(), std::min(path.size(), sizeof address.sun_path - 1), address.sun_path);
  return address;
}

bool somebody_listens(const std::string& path) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const sockaddr_un address = address_of(path);
  // EAGAIN: somebody who has not yet accepted those before.
  const bool answered = connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 || errno == EAGAIN;
  close(fd);
  return answered;
}

// 0 when the path is free, after removing a dead socket of this user's.
int clear_path(const std::string& path) {
  struct stat there {};
  if (lstat(path.c_str(), &there) != 0) return errno == ENOENT ? 0 : errno;
  if (!S_ISSOCK(there.st_mode) || (there.st_uid != geteuid() && geteuid() != 0)) return EEXIST;
  if (somebody_listens(path)) return EADDRINUSE;
  return unlink(path.c_str()) == 0 ? 0 : errno;
}

int set_access(const std::string& path, const OperatorServer::Access& access) {
  if (!access.group.empty()) {
    const group* entry = getgrnam(access.group.c_str());
    if (entry == nullptr) return ENOENT;
    if (chown(path.c_str(), static_cast<uid_t>(-1), entry->gr_gid) != 0) return errno;
  }
  return chmod(path.c_str(), access.everyone ? 0666 : 0660) == 0 ? 0 : errno;
}

}  // namespace

OperatorServer::OperatorServer(Take take, IsStop is_stop, const Limits& limits)
    : take_(std::move(take)), is_stop_(std::move(is_stop)), limits_(limits) {
  clients_.reserve(limits.clients);
}

OperatorServer::~OperatorServer() {
  for (const Client& client : clients_) close(client.fd);
  if (listener_ < 0) return;
  close(listener_);
  struct stat there {};
  const bool ours = lstat(path_.c_str(), &there) == 0 && there.st_dev == device_ && there.st_ino == inode_;
  if (ours) unlink(path_.c_str());
}

int OperatorServer::open(const std::string& path, const Access& access) {
  if (path.size() >= sizeof(sockaddr_un::sun_path)) return ENAMETOOLONG;
  std::error_code ignored;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder, ignored);
  if (const int error = clear_path(path); error != 0) return error;
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return errno;
  const sockaddr_un address = address_of(path);
  const mode_t others = umask(0177);  // until its group is set nobody but this user opens it
  const bool bound = bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  int error = bound ? 0 : errno;
  umask(others);
  struct stat made {};
  if (error == 0 && lstat(path.c_str(), &made) != 0) error = errno;
  if (error == 0) error = set_access(path, access);
  if (error == 0 && listen(fd, backlog) != 0) error = errno;
  if (error != 0) {
    close(fd);
    if (bound) unlink(path.c_str());
    return error;
  }
  listener_ = fd;
  path_ = path;
  device_ = made.st_dev;
  inode_ = made.st_ino;
  return 0;
}

std::string OperatorServer::explain(int error, const std::string& path) {
  switch (error) {
    case EADDRINUSE: return path + ": another lanternfishd answers there; `operator.socket` names another place";
    case EEXIST:
      return path + ": something stands there that is no socket of this user's; remove it, or name another place by `operator.socket`";
    case ENOENT: return path + ": no such folder, or `operator.group` names a group that there is none of";
    default: return path + ": " + std::strerror(error) + "; `operator.socket` names another place";
  }
}

void OperatorServer::let_go(Client& client) {
  close(client.fd);
  client.fd = -1;
  if (client.waits_for != 0 && gone_) gone_(client.waits_for);
}

void OperatorServer::forget_gone() {
  std::erase_if(clients_, [](const Client& client) { return client.fd < 0; });
}

// One that waits for an answer makes way last.
bool OperatorServer::make_room(unsigned user) {
  std::map<unsigned, std::size_t> shares;
  for (const Client& client : clients_) ++shares[client.user];
  const bool share_is_full = shares[user] >= limits_.clients_a_user;
  if (!share_is_full && clients_.size() < limits_.clients) return true;
  const auto most = std::max_element(shares.begin(), shares.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const unsigned from = share_is_full ? user : most->first;
  Client* silent = nullptr;
  for (Client& client : clients_) {
    if (client.user != from) continue;
    const bool better =
        silent == nullptr || std::pair(client.waits_for != 0, client.heard) < std::pair(silent->waits_for != 0, silent->heard);
    if (better) silent = &client;
  }
  if (silent == nullptr) return false;
  ++stats_.made_way;
  let_go(*silent);
  forget_gone();
  return true;
}

void OperatorServer::accept_new(Time now) {
  for (std::size_t i = 0; i < limits_.accepted_a_turn; ++i) {
    const int fd = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) return;
    ucred peer{};
    socklen_t bytes = sizeof peer;
    if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &bytes) != 0 || !make_room(peer.uid)) {
      close(fd);
      continue;
    }
    Client client;
    client.fd = fd;
    client.user = peer.uid;
    client.heard = now;
    clients_.push_back(std::move(client));
  }
}

void OperatorServer::read(Client& client, bool hung_up) {
  std::array<char, 4096> buffer{};
  const ssize_t bytes = recv(client.fd, buffer.data(), buffer.size(), 0);
  if (bytes == 0 && !hung_up) client.waits_for = 0;  // it may still read: its order goes on
  if (bytes == 0 || (bytes < 0 && errno != EAGAIN && errno != EINTR)) return let_go(client);
  if (bytes > 0) client.text.append(buffer.data(), static_cast<std::size_t>(bytes));
}

bool OperatorServer::cut_line(Client& client, std::string& line) {
  const std::size_t end = client.text.find('\n');
  if (end == std::string::npos) return false;
  line = client.text.substr(0, end);
  client.text.erase(0, end + 1);
  client.searched -= std::min(client.searched, end + 1);
  return true;
}

void OperatorServer::send_line(Client& client, const std::string& answer) {
  const std::string line = answer + "\n";
  if (send(client.fd, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT) == static_cast<ssize_t>(line.size())) return;
  ++stats_.let_go;
  let_go(client);
}

// Its line goes on, and nothing behind it can be told from it.
void OperatorServer::refuse_length(Client& client) {
  send_line(client, R"({"ok":false,"why":"a line has at most )" + std::to_string(limits_.longest_line) + R"( bytes"})");
  if (client.fd < 0) return;
  ++stats_.let_go;
  let_go(client);
}

// What stands before a stop would be done after it, or keep it waiting: it is answered and dropped.
void OperatorServer::overtake(Client& client, Time now) {
  for (std::size_t end = client.text.find('\n', client.searched); end != std::string::npos; end = client.text.find('\n', client.searched)) {
    const std::string_view line = std::string_view(client.text).substr(client.searched, end - client.searched);
    const std::size_t begin = client.searched;
    client.searched = end + 1;
    if (!is_stop_(line)) continue;
    // An answer that is still owed comes first, so that answers stand in the order of their lines.
    if (client.waits_for != 0) {
      client.waits_for = 0;
      ++stats_.overtaken;
      send_line(client, overtaken);
    }
    const auto before =
        static_cast<std::size_t>(std::count(client.text.begin(), client.text.begin() + static_cast<std::ptrdiff_t>(begin), '\n'));
    client.text.erase(0, begin);
    client.searched = 0;
    stats_.overtaken += before;
    for (std::size_t i = 0; i < before && client.fd >= 0; ++i) send_line(client, overtaken);
    if (client.fd < 0) return;
    take_line(client, now);
    if (client.fd < 0) return;
    client.searched = 0;
  }
}

void OperatorServer::take_line(Client& client, Time now) {
  std::string line;
  if (!cut_line(client, line)) return;
  client.heard = now;
  ++stats_.lines;
  const Ticket ticket = ++last_ticket_;
  if (const std::optional<std::string> answer = take_(line, client.user, ticket)) {
    send_line(client, *answer);
  } else {
    client.waits_for = ticket;
  }
}

void OperatorServer::reply(Ticket ticket, const std::string& answer) {
  for (Client& client : clients_) {
    if (client.waits_for != ticket) continue;
    client.waits_for = 0;
    send_line(client, answer);
  }
  forget_gone();
}

void OperatorServer::serve(Duration how_long, int wake) {
  std::vector<pollfd> polled{{wake, POLLIN, 0}, {listener_, POLLIN, 0}};
  bool lines_wait = false;
  for (const Client& client : clients_) {
    // Who fills its text is not read from until lines of it were taken.
    const bool full = client.text.size() > limits_.longest_line;
    polled.push_back({client.fd, static_cast<short>(full ? 0 : POLLIN), 0});
    lines_wait = lines_wait || has_line(client);
  }
  const int ready = poll(polled.data(), polled.size(), lines_wait ? 0 : static_cast<int>(how_long.ns() / 1'000'000));
  const Time now = monotonic_now();
  for (std::size_t i = 0; ready > 0 && i < clients_.size(); ++i) {
    const short come = polled[i + 2].revents;
    if (come != 0) read(clients_[i], (come & (POLLHUP | POLLERR)) != 0);
  }
  forget_gone();
  for (Client& client : clients_) overtake(client, now);
  forget_gone();
  for (Client& client : clients_) {
    if (has_line(client)) take_line(client, now);
    if (client.fd < 0) continue;
    const bool endless = client.text.size() > limits_.longest_line && client.text.find('\n') == std::string::npos;
    const bool idle = client.waits_for == 0 && now - client.heard > limits_.idle;
    stats_.idle += !endless && idle ? 1 : 0;
    if (endless) refuse_length(client);
    if (idle && client.fd >= 0) let_go(client);
  }
  forget_gone();
  if (ready > 0 && polled[1].revents != 0) accept_new(now);
}

}  // namespace lf::hal
