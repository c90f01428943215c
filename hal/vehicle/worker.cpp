#include "hal/vehicle/worker.hpp"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "hal/vehicle/realtime.hpp"

namespace lf::hal {

namespace {

constexpr std::size_t most_waiting = 64;

}  // namespace

struct Worker::State {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::function<void()>> waiting;
  bool at_work = false;
  bool stops = false;

  void run() {
    std::unique_lock lock(mutex);
    while (!stops) {
      if (waiting.empty()) {
        changed.wait(lock);
        continue;
      }
      const std::function<void()> work = std::move(waiting.front());
      waiting.pop_front();
      at_work = true;
      lock.unlock();
      work();
      lock.lock();
      at_work = false;
      changed.notify_all();
    }
  }
};

Worker::Worker(std::string name) : state_(std::make_shared<State>()) {
  std::thread([state = state_, name = std::move(name)] {
    name_thread(name.c_str());
    state->run();
  }).detach();
}

Worker::~Worker() {
  const std::lock_guard lock(state_->mutex);
  state_->stops = true;
  state_->waiting.clear();
  state_->changed.notify_all();
}

bool Worker::post(std::function<void()> work) {
  const std::lock_guard lock(state_->mutex);
  if (state_->waiting.size() >= most_waiting) return false;
  state_->waiting.push_back(std::move(work));
  state_->changed.notify_all();
  return true;
}

bool Worker::idle() const {
  const std::lock_guard lock(state_->mutex);
  return state_->waiting.empty() && !state_->at_work;
}

void Worker::finish() {
  std::unique_lock lock(state_->mutex);
  state_->changed.wait(lock, [this] { return state_->waiting.empty() && !state_->at_work; });
}

}  // namespace lf::hal
