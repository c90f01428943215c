#!/usr/bin/env bash
# Builds firmware/ and its unit tests with AddressSanitizer and UndefinedBehaviorSanitizer and runs them: a shard of tests/nightly.sh.
# The assembled daemon is one of them where it is built (tests/unit/vehicle). `./test.sh asan` and `./test.sh tsan` do the same for everything.
# Usage: tests/sanitized_core.sh [PROGRAM]...     PROGRAM: of build/core-asan/tests; default: the core's
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
programs=("$@")
[ $# -gt 0 ] || programs=(test_canopen test_safety test_arm test_mission test_scan)
build=build/core-asan
cmake --preset core-asan >"$build.log" 2>&1 && cmake --build --preset core-asan --target "${programs[@]}" -- --quiet >>"$build.log" 2>&1 ||
  { tail -n 40 "$build.log"; exit 1; }
for program in "${programs[@]}"; do
  echo "--- $program"
  # OpenCV's libraries, which some tests link, leave memory behind at the end.
  ASAN_OPTIONS=detect_leaks=0 "$build/tests/$program" --gtest_brief=1
done
