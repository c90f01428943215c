// A table of keys spelled out as YAML: every key with its value, its meaning, its range, and its default where the value is another. In the table's order, but
// for groups whose keys stand apart in it.
#pragma once

#include <string>

#include "hal/config/key.hpp"

namespace lf::config {

// `defaults` is the same table, bound to an object that nobody changed. The reader of `table`'s files takes the text, and reads the same values from it.
std::string key_listing(const Keys& table, const Keys& defaults);

}  // namespace lf::config
