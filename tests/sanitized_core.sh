#!/usr/bin/env bash
# Builds test programs with AddressSanitizer and UndefinedBehaviorSanitizer, and runs them. `./test.sh asan` and `./test.sh tsan` do it for everything.
# The checks of null, alignment and object size are left to `asan`, shards of tests/nightly.sh: they take a third of the compiler's time.
# Usage: tests/sanitized_core.sh [--all-checks] [--build | --fuzz] [PROGRAM]...
#   --all-checks  with the preset `asan`, which leaves out no check
#   --build       they are built only
#   --fuzz        the fuzz targets, too: their kept inputs and seeded changes of them are replayed (a shard of tests/nightly.sh)
#   PROGRAM       a test program, or a pattern of some: 'test_hil_*'; default: the core's unit tests and the assembled daemon, as `./test.sh` runs them. Those
#                 that need a guest are left out of a pattern.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
targets=() only_build='' preset=core-asan
[ "${1:-}" != --all-checks ] || { shift; preset=asan; }
[ "${1:-}" != --build ] || { shift; only_build=yes; }
if [ "${1:-}" = --fuzz ]; then
  shift
  mapfile -t targets < <(sed -nE 's/^lanternfish_fuzz\(([a-z_]+) .*/fuzz_\1/p' tests/fuzz/CMakeLists.txt)
  targets+=(fuzz_hang)
fi
programs=("$@")
[ $# -gt 0 ] || programs=(test_canopen test_safety test_arm test_mission test_scan test_hil_daemon)
# Of the daemon's clock: its programs are some three times slower than without.
export LANTERNFISH_SLOWDOWN=${LANTERNFISH_SLOWDOWN:-4}
build=build/$preset
mkdir -p "$build"
exec 9>"$build/lock"
flock 9  # two of them would build the same files
toolchain/configure.sh "$preset" >"$build.log" 2>&1 || { tail -n 40 "$build.log"; exit 1; }
if [[ ${programs[*]} == *'*'* ]]; then
  mapfile -t known < <(ninja -C "$build" -t targets all | sed -nE 's/^(test_[a-z_]+): phony$/\1/p' | grep -vE '^test_(vcan|qemu)_')
  patterns=("${programs[@]}") programs=()
  for program in "${known[@]}"; do
    for pattern in "${patterns[@]}"; do
      # shellcheck disable=SC2053 # a pattern
      [[ $program != $pattern ]] || programs+=("$program")
    done
  done
fi
cmake --build --preset "$preset" --target "${programs[@]}" "${targets[@]}" -- --quiet >>"$build.log" 2>&1 || { tail -n 40 "$build.log"; exit 1; }
exec 9>&-
[ -z "$only_build" ] || exit 0
failed=()
for program in "${programs[@]}"; do
  echo "--- $program"
  # OpenCV's libraries, which some tests link, leave memory behind at the end.
  ASAN_OPTIONS=detect_leaks=0 "$build/tests/$program" --gtest_brief=1 || failed+=("$program")
done
[ ${#failed[@]} -eq 0 ] || { echo "failed: ${failed[*]}"; exit 1; }
[ ${#targets[@]} -eq 0 ] || ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1:detect_container_overflow=0 ctest --test-dir "$build" -R '^fuzz\.' -j2 --output-on-failure
