// What a key holds, as text: one line of YAML, and a row of the tables in docs/.
#pragma once

#include <string>

#include "hal/config/key.hpp"

namespace lf::config {

// The shortest text that reads back to the same number.
std::string number_text(double value);

// A key's value as YAML in one line.
std::string value_text(const Key& key);

// "| `path` | takes | default | range | meaning |", with the value as default.
std::string markdown_row(const Key& key, const std::string& prefix = "", bool with_default = true);
inline constexpr const char* markdown_head = "| key | takes | default | range | meaning |\n|---|---|---|---|---|\n";

}  // namespace lf::config
