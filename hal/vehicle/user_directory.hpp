// Who is behind a user's number: name and role. Looked up on a thread of its own, since a directory service may take half a minute to answer.
//
// Root and the daemon's own user are engineers and known at once. One thread asks.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "hal/vehicle/operator_rights.hpp"
#include "hal/vehicle/worker.hpp"
#include "shared/messages/time.hpp"

namespace lf::hal {

struct User {
  std::string name;  // "user 1234" for a number without a name
  Role role = Role::watcher;
};

class UserDirectory {
 public:
  // Blocks; called on the directory's own thread.
  using LookUp = std::function<User(unsigned user)>;

  explicit UserDirectory(LookUp look_up);

  // Nothing while the first look-up is under way: ask again. What is known is looked up anew after a minute, and holds until the new answer has come.
  std::optional<User> find(unsigned user, Time now);

 private:
  struct Entry {
    std::optional<User> user;
    std::optional<Time> asked;  // while a look-up is under way or young
  };
  struct Found {
    std::mutex mutex;
    std::map<unsigned, User> users;  // answers that were not yet taken over
  };

  LookUp look_up_;
  std::map<unsigned, Entry> known_;
  std::shared_ptr<Found> found_ = std::make_shared<Found>();
  Worker worker_{"users"};
};

// Name, and role by the lists of users and @groups. Blocks.
User look_up_user(unsigned user, const std::vector<std::string>& operators, const std::vector<std::string>& engineers);

}  // namespace lf::hal
