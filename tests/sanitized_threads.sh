#!/usr/bin/env bash
# Builds the programs in which threads of ours meet with ThreadSanitizer, and runs them. What runs on one thread has nothing to race with, and is left to `asan`.
# Usage: tests/sanitized_threads.sh [--build]     --build  they are built only
#
# The threads: vision's and the renderer's worker beside the mission (test_hil_mission, `lanternfish run`), the daemon's control, log, bus and operator threads
# (test_hil_daemon, test_vehicle, test_serve), the camera's ring (test_frame_ring), the renderer's pool (test_optics, test_pointer_rendered), OpenCV's own under
# the detectors (test_vision), and the missions of a campaign side by side.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
tests=(test_frame_ring test_vehicle test_serve test_optics test_vision test_pointer_rendered test_hil_mission test_hil_daemon)
# Of the daemon's clock.
export LANTERNFISH_SLOWDOWN=${LANTERNFISH_SLOWDOWN:-8}
build=build/tsan
mkdir -p "$build"
toolchain/configure.sh tsan >"$build/configure.log"
cmake --build --preset tsan --target "${tests[@]}" lanternfish -- --quiet
[ "${1:-}" != --build ] || exit 0

failed=()
run() {
  local name=$1
  shift
  echo "--- $name"
  "$@" || failed+=("$name")
}
# Missions have the same threads all the way: one is flown whole below, and two in a campaign. Here they go as far as the sweep, with one thread of the renderer and two.
declare -A only=([test_hil_mission]='Digest.*')
for test in "${tests[@]}"; do run "$test" "$build/tests/$test" --gtest_brief=1 --gtest_filter="${only[$test]:-*}"; done
run "a mission" "$build/bin/lanternfish" run default --out "$build/run"
run "a campaign" "$build/bin/lanternfish" campaign default --seeds 1-2 --out "$build/campaign"
[ ${#failed[@]} -eq 0 ] || { printf 'failed: %s\n' "${failed[*]}"; exit 1; }
echo "no race in ${#tests[@]} test programs, a mission and a campaign"
