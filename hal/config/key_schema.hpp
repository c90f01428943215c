// A table of keys as a JSON Schema, with which editors check a file while it is written.
#pragma once

#include <string>

#include "hal/config/key.hpp"

namespace lf::config {

// JSON Schema (2020-12) of a file with these keys and no others: types, ranges, words, and each key's meaning with its unit.
std::string key_schema(const Keys& table, const std::string& title);

// The same of a file that has its version and one list, each of whose items has these keys, and `required` of them.
std::string list_file_schema(const std::string& list, const Keys& item, const std::vector<std::string>& required, std::int64_t version,
                             const std::string& title);

}  // namespace lf::config
