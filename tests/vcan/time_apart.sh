#!/usr/bin/env bash
# Runs a GoogleTest program in two parts, so that its exit status tells function from time (toolchain/guests/keeping_time.py).
# Usage: time_apart.sh PROGRAM FILTER    FILTER: the cases whose limits a machine that stands still for a SYNC period can miss
# Exit status: 1 when one of the other cases fails, 75 when only cases of FILTER do.
set -euo pipefail
"$1" --gtest_filter="-$2" || exit 1
"$1" --gtest_filter="$2" && exit 0
[ -z "${LANTERNFISH_GUEST_OUT:-}" ] || echo 4 >"$LANTERNFISH_GUEST_OUT/missed_ms"
exit 75
