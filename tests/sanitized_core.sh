#!/usr/bin/env bash
# Builds firmware/, its unit tests and the fuzz targets with AddressSanitizer and UndefinedBehaviorSanitizer, runs the tests, and replays the targets' kept
# inputs and seeded changes of them: a shard of tests/nightly.sh.
# The assembled daemon is one of them where it is built (tests/unit/vehicle). `./test.sh asan` and `./test.sh tsan` do the same for everything.
# Usage: tests/sanitized_core.sh [PROGRAM]...     PROGRAM: of build/core-asan/tests; default: the core's
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
programs=("$@")
targets=()
if [ $# -eq 0 ]; then
  programs=(test_canopen test_safety test_arm test_mission test_scan)
  mapfile -t targets < <(sed -nE 's/^lanternfish_fuzz\(([a-z_]+) .*/fuzz_\1/p' tests/fuzz/CMakeLists.txt)
  targets+=(fuzz_hang)
fi
build=build/core-asan
cmake --preset core-asan >"$build.log" 2>&1 && cmake --build --preset core-asan --target "${programs[@]}" "${targets[@]}" -- --quiet >>"$build.log" 2>&1 ||
  { tail -n 40 "$build.log"; exit 1; }
for program in "${programs[@]}"; do
  echo "--- $program"
  # OpenCV's libraries, which some tests link, leave memory behind at the end.
  ASAN_OPTIONS=detect_leaks=0 "$build/tests/$program" --gtest_brief=1
done
[ ${#targets[@]} -eq 0 ] || ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1:detect_container_overflow=0 ctest --test-dir "$build" -R '^fuzz\.' -j2 --output-on-failure
