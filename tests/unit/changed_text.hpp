// A text with one part of it changed; the test fails where the part is not in it.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace lf::test {

inline void change(std::string& text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  ASSERT_NE(at, std::string::npos) << what;
  text.replace(at, what.size(), by);
}

}  // namespace lf::test
