// What an operator's line comes to: read, held against the user's role, handed to the control thread or done here, answered and logged.
//
// Never blocks: what takes time is answered later. An order that the control thread did not take within half a second is withdrawn, and will not run.
// One thread owns it, the one that serves the socket.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/vehicle/commissioner.hpp"
#include "hal/vehicle/control_loop.hpp"
#include "hal/vehicle/operator_server.hpp"
#include "hal/vehicle/parse_order.hpp"
#include "hal/vehicle/status_json.hpp"
#include "hal/vehicle/user_directory.hpp"
#include "hal/vehicle/worker.hpp"

namespace lf::hal {

class OrderDesk {
 public:
  using Ticket = OperatorServer::Ticket;
  using Reply = std::function<void(Ticket ticket, const std::string& answer)>;

  struct Ways {
    std::function<Json()> status;
    std::function<int()> restart_bus;                           // 0 or errno; may block: called on a thread of its own
    std::function<void(const Json&)> log;                       // a line of log.jsonl
    std::function<User(unsigned)> look_up;                      // may block: called on a thread of its own
    std::string interface;                                      // for messages
    PanelNames names;                                           // by which orders name valves and buttons
    JointNames joints;                                          // and joints
    std::function<std::string()> no_sight;                      // why there is no camera, in words; empty: there is one
    std::function<std::string(const mission::Tasks&)> why_not;  // tasks that this machine cannot do, in words; empty: it can
    Commissioner* commissioner = nullptr;                       // of the same thread; outlives the desk
  };

  OrderDesk(LoopRings& rings, Ways ways);

  // The answer to a line, or nothing when settle() brings it.
  std::optional<std::string> take(const std::string& line, unsigned user, Ticket ticket);
  // Answers what has come to an end since.
  void settle(const Reply& reply);
  // The client of a line that waits has hung up: nobody reads its answer.
  void gone(Ticket ticket) { gone_.push_back(ticket); }
  bool settled() const { return waiting_.empty(); }

  static bool is_stop(std::string_view line);

 private:
  enum class Waits : std::uint8_t { for_user, for_control, for_bus, for_commissioner };
  struct Waiting {
    Ticket ticket = 0;
    std::string line;
    unsigned user = 0;
    OperatorRequest request;
    Waits waits = Waits::for_user;
    Time since;
    std::uint64_t number = 0;                 // of the order, for_control
    bool taken = false;                       // the control thread has it, but has not answered
    std::uint64_t stops_before = 0;           // given when it came
    bool called_off = false;                  // it called off a commissioning that may not have begun
    bool gone = false;                        // its client
    std::shared_ptr<std::optional<int>> bus;  // the restart's result, guarded by `bus_mutex_`
  };

  // The answer, or nothing: then `one` says what is waited for.
  std::optional<Json> judge(Waiting& one);
  std::optional<Json> begin(Waiting& one, const User& user);
  std::optional<Json> give(Waiting& one);
  std::optional<Json> look_again(Waiting& one);
  std::optional<Json> await_control(Waiting& one);
  std::optional<Json> await_bus(Waiting& one);
  std::optional<Json> begin_commissioning(Waiting& one);
  void drop_those_of_clients_gone();
  std::string finish(const Waiting& one, const Json& answer);

  LoopRings& rings_;
  Ways ways_;
  UserDirectory users_;
  Worker worker_{"bus"};
  std::shared_ptr<std::mutex> bus_mutex_ = std::make_shared<std::mutex>();
  std::vector<Waiting> waiting_;
  std::vector<OrderAnswer> answers_;  // of the control thread, not yet looked at
  std::vector<Ticket> gone_;
  std::uint64_t orders_given_ = 0;
  std::uint64_t stops_given_ = 0;
};

}  // namespace lf::hal
