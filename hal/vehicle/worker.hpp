// A thread for what may block: look-ups of users, requests to the kernel that wait for its answer, packing of logs.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace lf::hal {

class Worker {
 public:
  // `name` has at most 15 letters.
  explicit Worker(std::string name);
  // Waits for nothing: work that has not begun is dropped, and the thread ends by itself after the piece that it is at. A piece of work therefore owns
  // what it touches, or shares it.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // Does `work` after what was posted before. False, and nothing is done, when 64 pieces wait already. Never blocks for longer than a copy takes.
  bool post(std::function<void()> work);
  bool idle() const;
  // Waits until nothing is left to do: for an orderly end, and for tests.
  void finish();

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace lf::hal
