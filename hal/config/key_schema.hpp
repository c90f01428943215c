// A table of keys as a JSON Schema, with which editors check a file while it is written.
#pragma once

#include <string>

#include "hal/config/key.hpp"

namespace lf::config {

// JSON Schema (2020-12) of a file with these keys and no others: types, ranges, words, and each key's meaning with its unit.
std::string key_schema(const Keys& table, const std::string& title);

}  // namespace lf::config
