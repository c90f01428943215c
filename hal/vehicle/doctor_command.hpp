// `lanternfishd doctor`: this machine against the configuration, then the drives on the bus against their profiles.
#pragma once

#include <string>

namespace lf::hal {

struct DoctorRequest {
  std::string config;     // without one the bus alone is read
  std::string interface;  // in place of the configuration's
  bool machine_only = false;
  bool bus_only = false;
  bool json = false;
};

// Exit status: 0 all is good, or only notes; 1 the bus was read, and nobody answers, or a configured drive does not or differs from its profile; 2 the
// configuration is wrong; 3 this machine lacks something. The highest holds. Throws InputError and EnvironmentLacks where nothing could be looked at.
int run_doctor(const DoctorRequest& request);

}  // namespace lf::hal
