// What the core's operations compute from given inputs, value by value: on x86-64 it is written down, on another processor held to what was written.
#pragma once

#include <cstdint>

#include "shared/geometry/pose.hpp"

namespace lf::test {

class Ledger {
 public:
  // What follows are results of this operation. Numbers may differ by `tolerance` in their own unit; 0: not in a bit.
  virtual void operation(const char* name, double tolerance) = 0;
  virtual void number(double value) = 0;
  // Counts, outcomes and other integers: always equal.
  virtual void integer(std::uint64_t value) = 0;

  void numbers(const auto& values) {
    for (const auto value : values) number(value);
  }
  void pose(const Pose& pose) { numbers(pose.matrix().reshaped()); }

  // One turn of the operation: where instructions can be counted, they are.
  template <class Work>
  auto turn(Work&& work) {
    struct Stop {
      Ledger& ledger;
      ~Stop() { ledger.stop(); }
    };
    start();
    Stop stop{*this};
    return work();
  }

 protected:
  ~Ledger() = default;

 private:
  virtual void start() = 0;
  virtual void stop() = 0;
};

// Everything that is compared. Inputs are made by integer arithmetic, so that they are the same everywhere.
void put_arm(Ledger& ledger);
void put_scan(Ledger& ledger);
void put_pipelines(Ledger& ledger);
inline void put_everything(Ledger& ledger) {
  put_arm(ledger);
  put_scan(ledger);
  put_pipelines(ledger);
}

}  // namespace lf::test
