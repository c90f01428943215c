// As much of GoogleTest as the core's unit tests use, for a processor without streams, exceptions or threads: the same test files compile against it.
//
// A failure prints file, line, expression and, where they are numbers, both values; messages appended with << are not printed.
#pragma once

#include <cmath>
#include <cstring>
#include <ios>
#include <type_traits>

#include "toolchain/cortex_m7/semihosting.hpp"

namespace testing {

class Message {
 public:
  template <class T>
  Message& operator<<(const T&) {
    return *this;
  }
  Message& operator<<(std::ios_base& (*)(std::ios_base&)) { return *this; }
};

struct Counters {
  int checks = 0, failures = 0;
  bool fatal = false;  // in the test under way
};
inline Counters counters;

class Test {
 public:
  virtual ~Test() = default;
  virtual void SetUp() {}
  virtual void TearDown() {}
  virtual void TestBody() = 0;
  static bool HasFatalFailure() { return counters.fatal; }
};

inline void run(Test& test) {
  counters.fatal = false;
  test.SetUp();
  if (!counters.fatal) test.TestBody();
  test.TearDown();
}

// Known tests make a list by themselves, before main().
class Registration {
 public:
  Registration(const char* its_suite, const char* its_name, void (*its_run)())
      : suite(its_suite), name(its_name), run(its_run), next(first()) {
    first() = this;
  }
  static Registration*& first() {
    static Registration* head = nullptr;
    return head;
  }
  const char *suite, *name;
  void (*run)();
  Registration* next;
};

template <class T>
void print_value(const char* what, const T& value) {
  if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    lf::m7::print(what);
    lf::m7::print_number(static_cast<double>(value), std::is_floating_point_v<T> ? 12 : 0);
  }
}

class Fail {
 public:
  Fail(const char* file, int line, const char* expression, bool fatal) {
    ++counters.failures;
    counters.fatal = counters.fatal || fatal;
    lf::m7::print(file);
    lf::m7::print(":");
    lf::m7::print_number(line);
    lf::m7::print(": ");
    lf::m7::print(expression);
    lf::m7::print("\n");
  }
  void operator=(const Message&) {}
};

template <class A, class B, class Compare>
bool check(const A& a, const B& b, Compare compare) {
  ++counters.checks;
  if (compare(a, b)) return true;
  print_value("  left: ", a);
  print_value("  right: ", b);
  lf::m7::print("\n");
  return false;
}
inline bool check(bool good) {
  ++counters.checks;
  return good;
}
inline bool check_near(double a, double b, double tolerance) {
  return check(a, b, [tolerance](double x, double y) { return std::abs(x - y) <= tolerance; });
}

}  // namespace testing

#define LF_CHECK(good, text, fatal, leave) \
  switch (0)                               \
  case 0:                                  \
  default:                                 \
    if (good)                              \
      ;                                    \
    else                                   \
      leave ::testing::Fail(__FILE__, __LINE__, text, fatal) = ::testing::Message()
#define LF_COMPARE(a, b, op, fatal, leave) \
  LF_CHECK(::testing::check((a), (b), [](const auto& x, const auto& y) { return x op y; }), #a " " #op " " #b, fatal, leave)
#define LF_NOTHING

#define EXPECT_TRUE(c) LF_CHECK(::testing::check(static_cast<bool>(c)), #c, false, LF_NOTHING)
#define EXPECT_FALSE(c) LF_CHECK(::testing::check(!static_cast<bool>(c)), "not " #c, false, LF_NOTHING)
#define EXPECT_EQ(a, b) LF_COMPARE(a, b, ==, false, LF_NOTHING)
#define EXPECT_NE(a, b) LF_COMPARE(a, b, !=, false, LF_NOTHING)
#define EXPECT_LT(a, b) LF_COMPARE(a, b, <, false, LF_NOTHING)
#define EXPECT_LE(a, b) LF_COMPARE(a, b, <=, false, LF_NOTHING)
#define EXPECT_GT(a, b) LF_COMPARE(a, b, >, false, LF_NOTHING)
#define EXPECT_GE(a, b) LF_COMPARE(a, b, >=, false, LF_NOTHING)
#define EXPECT_NEAR(a, b, t) LF_CHECK(::testing::check_near((a), (b), (t)), #a " near " #b, false, LF_NOTHING)
#define EXPECT_STREQ(a, b) LF_CHECK(::testing::check(std::strcmp((a), (b)) == 0), #a " same text as " #b, false, LF_NOTHING)
#define ADD_FAILURE() LF_CHECK(::testing::check(false), "failure", false, LF_NOTHING)

#define ASSERT_TRUE(c) LF_CHECK(::testing::check(static_cast<bool>(c)), #c, true, return )
#define ASSERT_FALSE(c) LF_CHECK(::testing::check(!static_cast<bool>(c)), "not " #c, true, return )
#define ASSERT_EQ(a, b) LF_COMPARE(a, b, ==, true, return )
#define ASSERT_NE(a, b) LF_COMPARE(a, b, !=, true, return )
#define ASSERT_LT(a, b) LF_COMPARE(a, b, <, true, return )
#define ASSERT_LE(a, b) LF_COMPARE(a, b, <=, true, return )
#define ASSERT_GT(a, b) LF_COMPARE(a, b, >, true, return )
#define ASSERT_GE(a, b) LF_COMPARE(a, b, >=, true, return )
#define ASSERT_NEAR(a, b, t) LF_CHECK(::testing::check_near((a), (b), (t)), #a " near " #b, true, return )

#define SCOPED_TRACE(message) static_cast<void>(::testing::Message() << message)

#define LF_TEST(suite, name, base)                                                 \
  class suite##_##name##_Test final : public base {                                \
   public:                                                                         \
    void TestBody() override;                                                      \
  };                                                                               \
  static ::testing::Registration suite##_##name##_registration(#suite, #name, [] { \
    suite##_##name##_Test test;                                                    \
    ::testing::run(test);                                                          \
  });                                                                              \
  void suite##_##name##_Test::TestBody()
#define TEST(suite, name) LF_TEST(suite, name, ::testing::Test)
#define TEST_F(suite, name) LF_TEST(suite, name, suite)
