// A moment on the clock that is the same everywhere.
#pragma once

#include <ctime>
#include <string>

namespace lf::campaign {

// "2026-11-24T21:35:00Z" (ISO 8601, UTC).
std::string utc_text(std::time_t time);

}  // namespace lf::campaign
