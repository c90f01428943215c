// One line of `lanternfish bench`: ours and the peer, measured interleaved in one process.
#pragma once

#include <string>

namespace lf::bench {

struct Row {
  std::string name;
  double ours = 0, peer = 0;
  std::string peer_name;
  double ratio = 0;  // peer / ours for times: how many times faster we are
  std::string unit;
  std::string note;
};

}  // namespace lf::bench
