#!/usr/bin/env bash
# Builds the core's tests with gcov, runs them, and tells which lines and branches of firmware/ they execute (coverage.py has the bounds).
# Usage: tests/coverage.sh [--core]     --core: the core's own unit tests alone, without the simulated missions: some minutes; canopen/ and safety/ are judged
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/coverage
programs=(test_canopen test_safety test_arm test_mission)
[ "${1:-}" = --core ] || programs+=(test_scan test_hil_mission test_hil_orders test_hil_valve test_hil_safety test_hil_settings test_hil_start_up_faults)
toolchain/configure.sh coverage >/dev/null
cmake --build --preset coverage --target "${programs[@]}" -- --quiet
find "$build" -name '*.gcda' -delete
for program in "${programs[@]}"; do
  # A failing test is for ./test.sh to tell: here it executes lines all the same.
  "$build/tests/$program" --gtest_brief=1 >"$build/$program.log" 2>&1 || echo "coverage: $program failed, see $build/$program.log"
done
tests/coverage.py . "$build" tests/coverage_exceptions.txt --json "$build/coverage.json"
