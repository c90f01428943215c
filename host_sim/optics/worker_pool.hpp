// A fixed number of threads that work through numbered blocks. Which thread takes which block is left open, so a block's result must not depend on it.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace lf::optics {

class WorkerPool {
 public:
  explicit WorkerPool(int threads);  // the caller's included; 1 starts none
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // Calls work(0) .. work(blocks - 1) and returns when all are done. `work` must not throw.
  void run(int blocks, const std::function<void(int)>& work);

 private:
  void serve();
  void take_blocks();

  std::mutex mutex_;
  std::condition_variable start_, done_;
  const std::function<void(int)>* work_ = nullptr;
  std::atomic<int> next_{0};
  int blocks_ = 0;
  int busy_ = 0;
  std::uint64_t round_ = 0;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace lf::optics
