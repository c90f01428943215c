#!/usr/bin/env bash
# Installs what is missing, builds everything and runs the tests. At the end it lists the tests that were skipped, with their reasons,
# and counts those that were left out, by label.
# Usage: ./test.sh [PRESET [ctest arguments]]    PRESET: release, debug, asan, tsan; aarch64: the vehicle's side for 64-bit ARM, its unit tests under qemu-user
# Without a preset: release, less the tests in real time, which take a machine to themselves for eleven minutes, those of the packages, and some that are long.
# `./test.sh release` has those, too.
# Environment: LANTERNFISH_SKIPS_ALLOWED=N, more than N skipped tests are a failure (default: any number may be).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
others='vcan|qemu|realtime|package|long'
# One of them sleeps more than it works.
[ $# -gt 0 ] || set -- release -LE "$others" -j3
preset=$1
shift
if [ "$preset" = aarch64 ]; then
  toolchain/setup.sh --aarch64
  toolchain/aarch64/make_sysroot.sh build/aarch64-sysroot
else
  toolchain/setup.sh --tests
fi
toolchain/configure.sh "$preset"
cmake --build --preset "$preset" -- --quiet
report=$PWD/build/$preset/tests.xml
rm -f "$report"
[[ "$*" != *"$others"* ]] || echo "test: without the tests in real time, of the packages, and those that are long; ./test.sh release -L '$others' runs them"
status=0
ctest --preset "$preset" --output-junit "$report" "$@" || status=$?
all=$PWD/build/$preset/all_tests.json
ctest --preset "$preset" --show-only=json-v1 > "$all"
[ ! -e "$report" ] || tests/count_skips.py "$report" --all "$all" ${LANTERNFISH_SKIPS_ALLOWED:+--at-most "$LANTERNFISH_SKIPS_ALLOWED"} || status=1
exit "$status"
