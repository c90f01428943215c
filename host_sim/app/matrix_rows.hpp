// The rows of the fault matrix: which fault, or pair of faults, in which step. Nothing is flown here.
#pragma once

#include <string>
#include <vector>

#include "host_sim/app/fault_moment.hpp"
#include "host_sim/judge/fault_rules.hpp"

namespace lf::app {

struct MatrixRow {
  FaultMoment moment;
  std::vector<judge::Cause> causes;  // one, or two
  double apart_s = 0;                // of two

  std::string name() const;  // "turn: overcurrent elbow, then estop 0.12 s later"
};

struct MatrixChoice {
  std::vector<std::string> kinds;  // empty: all
  std::vector<std::string> steps;  // empty: all
  std::vector<std::string> rows;   // by MatrixRow::name(); empty: all
  bool pairs = false;
  std::size_t shard = 1, shards = 1;  // row i belongs to shard 1 + i mod shards
  std::size_t one_in = 1;             // a sample: of each shard's rows
  double into = usual_share_of_step;  // of the steps, where the faults are made: each has a sample of its own
};

// What is true from power-on or not at all happens there only.
bool happens_in(const judge::Cause& cause, const std::string& step);

// Throws InputError for a kind, step or row that there is not.
std::vector<MatrixRow> matrix_rows(const std::vector<FaultMoment>& moments, const MatrixChoice& choice, const judge::BusNodes& bus = {});

}  // namespace lf::app
