// Renders exposures on a thread of its own while the world steps on.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "host_sim/optics/optics.hpp"

namespace lf::hal {

// Shots are rendered in the order of their submission, each into a frame of its own; what comes out does not depend on when it is joined.
class RenderWorker {
 public:
  using Ticket = std::uint64_t;

  // Throws what optics::Optics throws.
  explicit RenderWorker(const optics::OpticsConfig& config);
  ~RenderWorker();
  RenderWorker(const RenderWorker&) = delete;
  RenderWorker& operator=(const RenderWorker&) = delete;

  Ticket submit(const optics::Shot& shot);

  // True when wait() would return at once.
  bool ready(Ticket ticket);

  // Blocks until the shot is rendered and moves it into `frame`, whose memory is taken for later shots. Tickets are joined in their order, each once.
  // Rethrows what rendering threw.
  void wait(Ticket ticket, optics::Frame& frame);

 private:
  void work();

  optics::Optics optics_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable rendered_;
  struct Done {
    Ticket ticket = 0;
    optics::Frame frame;
    std::exception_ptr error;
  };
  std::deque<std::pair<Ticket, optics::Shot>> shots_;
  std::deque<Done> done_;
  std::deque<optics::Frame> spare_;
  Ticket next_ = 1;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace lf::hal
