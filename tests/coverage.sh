#!/usr/bin/env bash
# Builds the core's tests with gcov, runs them, and tells which lines and branches of firmware/ they execute (coverage.py has the bounds).
# Usage: tests/coverage.sh [--core]     --core: the core's own unit tests alone, without the simulated missions: some minutes; canopen/ and safety/ are judged.
# Without it each line of the core is executed, or stands in coverage_exceptions.txt with its reason. Ways that only a fault leads to are flown: rows of the matrix.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/coverage
programs=(test_canopen test_safety test_arm test_mission)
missions=()
failed=()
if [ "${1:-}" != --core ]; then
  programs+=(test_scan)
  for part in buttons drives looks mission orders phases safety settings start_up_faults stop torque valve way_home; do programs+=("test_hil_$part"); done
  missions=(lanternfish)
fi
toolchain/configure.sh coverage >/dev/null
cmake --build --preset coverage --target "${programs[@]}" "${missions[@]}" -- --quiet
find "$build" -name '*.gcda' -delete
for program in "${programs[@]}"; do
  # A failing program executes lines all the same: they are counted, and the run fails at its end.
  "$build/tests/$program" --gtest_brief=1 >"$build/$program.log" 2>&1 || failed+=("$program, see $build/$program.log")
done
fly() {
  rm -rf "$build/flown"
  "$build/bin/lanternfish" campaign default --out "$build/flown" "$@" >"$build/flown.log" 2>&1 || failed+=("a campaign, see $build/flown.log")
}
if [ ${#missions[@]} -gt 0 ]; then
  fly --faults --one-in 20
  fly --faults --pairs --one-in 100
  fly --seeds 1-4
fi
[ ${#failed[@]} -eq 0 ] || printf 'coverage: failed: %s\n' "${failed[@]}"
tests/coverage.py . "$build" tests/coverage_exceptions.txt --json "$build/coverage.json" ${missions:+--whole}
[ ${#failed[@]} -eq 0 ]
