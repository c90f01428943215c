// The operator's end of the socket: one request, one answer.
#pragma once

#include <string>

#include "hal/vehicle/status_json.hpp"

namespace lf::hal {

// Throws EnvironmentLacks when no daemon answers there within 5 s.
Json ask_daemon(const std::string& socket, const Json& request);

// A status as people read it.
std::string status_text(const Json& status);

// What a commissioning that is done has found, a line each joint: its zero, and its friction with the fit's residual.
std::string commissioning_text(const Json& done);

}  // namespace lf::hal
