#include "hal/vehicle/user_directory.hpp"

#include <pwd.h>
#include <unistd.h>

#include <utility>

namespace lf::hal {

namespace {

constexpr Duration fresh_for = Duration::from_s(60);
// More users than any vehicle has: numbers of users that come and go do not fill the memory.
constexpr std::size_t most_known = 256;

}  // namespace

UserDirectory::UserDirectory(LookUp look_up) : look_up_(std::move(look_up)) {
  for (const unsigned user : {0U, static_cast<unsigned>(geteuid())})
    known_[user].user = User{user == 0 ? "root" : "the daemon's user", Role::engineer};
}

std::optional<User> UserDirectory::find(unsigned user, Time now) {
  {
    const std::lock_guard lock(found_->mutex);
    for (auto& [number, answer] : found_->users) known_[number].user = std::move(answer);
    found_->users.clear();
  }
  if (known_.size() >= most_known && !known_.contains(user))
    std::erase_if(known_, [](const auto& one) { return one.second.asked.has_value(); });
  Entry& entry = known_[user];
  if (!entry.asked || now - *entry.asked >= fresh_for) {
    const bool posted = worker_.post([found = found_, look_up = look_up_, user] {
      User answer = look_up(user);
      const std::lock_guard lock(found->mutex);
      found->users[user] = std::move(answer);
    });
    if (posted) entry.asked = now;
  }
  return entry.user;
}

User look_up_user(unsigned user, const std::vector<std::string>& operators, const std::vector<std::string>& engineers) {
  const passwd* entry = getpwuid(user);
  return {entry != nullptr ? entry->pw_name : "user " + std::to_string(user), role_of_user(user, operators, engineers)};
}

}  // namespace lf::hal
