// For enumerations that people read: every value has a name of its own, and what is no value says so.
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace lf::test {

// `name_of(value)` for the values 0 to `count` - 1, and for one beyond: `unknown`.
template <class Enum, class Name>
void expect_all_named(std::size_t count, const Name& name_of, const std::string& unknown = "unknown") {
  std::set<std::string> names;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = name_of(static_cast<Enum>(i));
    EXPECT_FALSE(name.empty()) << i;
    EXPECT_TRUE(names.insert(name).second) << name << " stands twice";
  }
  EXPECT_FALSE(names.contains(unknown));
  EXPECT_EQ(name_of(static_cast<Enum>(200)), unknown);
}

}  // namespace lf::test
