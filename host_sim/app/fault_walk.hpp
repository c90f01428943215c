// The ways through the mission's table of steps along which faults are made: each step is reached by one of them.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "host_sim/app/fault_moment.hpp"
#include "host_sim/app/flight.hpp"

namespace lf::app {

// A way through the steps, and the operator who orders it.
class FaultWalk {
 public:
  explicit FaultWalk(std::string name);

  const std::string& name() const { return name_; }
  bool by_hand() const { return name_ == "by hand"; }
  // Whether the mission succeeds at the end of this walk, unless a fault is made on it.
  bool succeeds() const { return name_ == "mission" || stops_and_starts_anew(); }
  // The mission stands where the walk itself stopped it: it goes on from there.
  bool goes_on_after(const Flight& flight) const {
    return stops_and_starts_anew() && !reset_ && flight.mission_step() == mission::Step::stopped;
  }
  // The scenario with the faults that lead this way.
  scenario::Scenario with_its_faults(const scenario::Scenario& base) const;
  // Before each control period: gives the orders that are due.
  void give_orders(Flight& flight);

  // "mission", "by hand", "aborted", "stopped", "held", "shut down", "started anew"
  static const std::vector<std::string>& names();

 private:
  bool stops_and_starts_anew() const { return name_ == "started anew"; }
  void start_anew(Flight& flight);
  void jog(Flight& flight);

  std::string name_;
  bool begun_ = false, jogged_ = false, reset_ = false, started_anew_ = false;
  double waiting_s_ = -1;  // since when the mission waits for orders
};

// One moment for each step of the table that can be reached, in the order of the walks and of time: this share of the step's duration in.
// `wanted`: names of steps; the walks end as soon as these are known. Empty: all. An interrupt ends it early: what it gives then is of no use.
std::vector<FaultMoment> survey_moments(const scenario::Scenario& base, double share_of_step = usual_share_of_step,
                                        const std::set<std::string>& wanted = {});

}  // namespace lf::app
