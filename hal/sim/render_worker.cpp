#include "hal/sim/render_worker.hpp"

#include <utility>

namespace lf::hal {

RenderWorker::RenderWorker(const optics::OpticsConfig& config) : optics_(config), thread_([this] { work(); }) {}

RenderWorker::~RenderWorker() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    shots_.clear();
  }
  wake_.notify_all();
  thread_.join();
}

RenderWorker::Ticket RenderWorker::submit(const optics::Shot& shot) {
  const std::lock_guard lock(mutex_);
  shots_.emplace_back(next_, shot);
  wake_.notify_all();
  return next_++;
}

bool RenderWorker::ready(Ticket ticket) {
  const std::lock_guard lock(mutex_);
  return !done_.empty() && done_.front().ticket >= ticket;
}

void RenderWorker::wait(Ticket ticket, optics::Frame& frame) {
  std::unique_lock lock(mutex_);
  rendered_.wait(lock, [&] { return !done_.empty() && done_.front().ticket >= ticket; });
  Done done = std::move(done_.front());
  done_.pop_front();
  if (done.error) std::rethrow_exception(done.error);
  std::swap(frame, done.frame);
  spare_.push_back(std::move(done.frame));
}

void RenderWorker::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stop_ || !shots_.empty(); });
    if (stop_) return;
    Done done;
    done.ticket = shots_.front().first;
    const optics::Shot shot = std::move(shots_.front().second);
    shots_.pop_front();
    if (!spare_.empty()) {
      done.frame = std::move(spare_.front());
      spare_.pop_front();
    }
    lock.unlock();
    try {
      optics_.render(shot, done.frame);
    } catch (...) {
      done.error = std::current_exception();
    }
    lock.lock();
    done_.push_back(std::move(done));
    rendered_.notify_all();
  }
}

}  // namespace lf::hal
