// Orders while the simulator serves: one a line, from a FIFO or a file that grows. They make the faults that only a test or a trainer asks for.
//
//   camera freeze|drop|repeat|away SECONDS
//   fault KIND [NODE] [SECONDS]        KIND and NODE as in a scenario's `faults`; without SECONDS for the rest of the run
//   say TEXT                           into the log, to find one's way in it
#pragma once

#include <string>

#include "host_sim/serve/serve_loop.hpp"

namespace lf::serve {

class OrderReader {
 public:
  // Throws InputError when the file cannot be opened. Empty: no orders. A FIFO may have no writer yet, and lose and find them.
  explicit OrderReader(const std::string& file);
  ~OrderReader();
  OrderReader(const OrderReader&) = delete;
  OrderReader& operator=(const OrderReader&) = delete;

  // Carries out what has come since the last call. Never waits. An order that makes no sense is said and passed over.
  void carry_out(ServeLoop& loop, const ServeLoop::Say& say);

 private:
  int fd_ = -1;
  std::string rest_;  // of a line that is not whole yet
};

// One order. Throws InputError for what is none.
void carry_out(const std::string& line, ServeLoop& loop, const ServeLoop::Say& say);

}  // namespace lf::serve
