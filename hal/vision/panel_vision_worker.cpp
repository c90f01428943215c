#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "hal/vision/panel_vision.hpp"
#include "shared/messages/spsc_ring.hpp"

namespace lf::vision {

namespace {

// Invalid where the size and the pixels do not go together.
ImageView view_of(const PanelJob& job) {
  const bool complete =
      job.width > 0 && job.height > 0 && job.still.size() == static_cast<std::size_t>(job.width) * static_cast<std::size_t>(job.height);
  return complete ? ImageView{job.still.data(), job.width, job.height, job.width} : ImageView{};
}

}  // namespace

PanelJob PanelJob::copy(const PanelRequest& request, ImageView still, std::span<const CloudPoint> cloud) {
  PanelJob job;
  job.request = request;
  if (request.has_still && still.valid()) {
    job.width = still.width;
    job.height = still.height;
    for (std::int32_t v = 0; v < still.height; ++v) job.still.insert(job.still.end(), still.row(v), still.row(v) + still.width);
  }
  job.cloud.assign(cloud.begin(), cloud.end());
  return job;
}

struct PanelVisionWorker::Implementation {
  explicit Implementation(const PanelVisionConfig& c) : config(c), thread([this] { run(); }) {}
  ~Implementation() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    wake.notify_all();
    thread.join();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      wake.wait(lock, [this] { return stopping || has_job; });
      if (stopping) return;
      const PanelJob current = std::move(job);
      has_job = false;
      lock.unlock();
      bool failed = false;
      const ImageView still = view_of(current);
      const PanelResult result = analyse_panel(current.request, still, current.cloud, config, &failed);
      lock.lock();
      ++counters.answered;
      if (failed) ++counters.failed;
      answers.push(result);  // has room: a new job is taken only after the last answer was fetched
      answered.notify_all();
    }
  }

  bool fetch(PanelResult& result) {
    if (!answers.pop(result)) return false;
    open_jobs.store(0, std::memory_order_release);
    return true;
  }

  const PanelVisionConfig config;
  SpscRing<PanelResult, 2> answers;
  std::atomic<int> open_jobs{0};  // 1 from submit to the fetching of its answer
  mutable std::mutex mutex;
  std::condition_variable wake, answered;
  PanelJob job;
  bool has_job = false;
  bool stopping = false;
  Stats counters;
  std::atomic<std::uint32_t> refused{0};
  std::thread thread;  // last: it uses all of the above
};

PanelVisionWorker::PanelVisionWorker(const PanelVisionConfig& config) : implementation_(std::make_unique<Implementation>(config)) {}
PanelVisionWorker::~PanelVisionWorker() = default;

bool PanelVisionWorker::submit(PanelJob job) {
  Implementation& own = *implementation_;
  int idle = 0;
  if (!own.open_jobs.compare_exchange_strong(idle, 1, std::memory_order_acq_rel)) {
    own.refused.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  {
    const std::lock_guard lock(own.mutex);  // held by the worker for moments only: it computes unlocked
    own.job = std::move(job);
    own.has_job = true;
    ++own.counters.accepted;
  }
  own.wake.notify_one();
  return true;
}

bool PanelVisionWorker::poll(PanelResult& result) { return implementation_->fetch(result); }

bool PanelVisionWorker::wait(PanelResult& result) {
  Implementation& own = *implementation_;
  std::unique_lock lock(own.mutex);
  while (!own.fetch(result)) {
    if (!busy()) return false;
    own.answered.wait(lock);
  }
  return true;
}

bool PanelVisionWorker::busy() const { return implementation_->open_jobs.load(std::memory_order_acquire) != 0; }

PanelVisionWorker::Stats PanelVisionWorker::stats() const {
  const std::lock_guard lock(implementation_->mutex);
  Stats stats = implementation_->counters;
  stats.refused = implementation_->refused.load(std::memory_order_relaxed);
  return stats;
}

}  // namespace lf::vision
