// Texts in a row.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lf::config {

// Problems, a line each; or names, with ", " between them.
inline std::string joined(const std::vector<std::string>& texts, std::string_view between = "\n") {
  std::string all;
  for (const std::string& text : texts) {
    if (!all.empty()) all += between;
    all += text;
  }
  return all;
}

}  // namespace lf::config
