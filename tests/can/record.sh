#!/bin/sh
# Records five seconds of a mission, cut short on purpose: record.sh LANTERNFISH RUN_DIR [SCENARIO SET...]
program=$1 run=$2 scenario=${3:-default}
shift 2
[ $# -eq 0 ] || shift
rm -rf "$run"
for key in "$@"; do set -- "$@" --set "$key"; shift; done
"$program" run "$scenario" --no-outside --out "$run" --set time_limit_s=5 \
  --set 'faults=[{at_s: 3.0, kind: overcurrent, node: elbow, duration_s: 0.2}]' "$@" --json >/dev/null
status=$?
[ $status -eq 1 ] || { echo "record.sh: the run ended with $status, not with the time limit's 1"; exit 1; }
[ -s "$run/can0.log" ] && [ -s "$run/joints.csv" ]
