#!/bin/sh
# Records five seconds of a mission, cut short on purpose: record.sh LANTERNFISH RUN_DIR
rm -rf "$2"
"$1" run --no-outside --out "$2" --set time_limit_s=5 \
  --set 'faults=[{at_s: 3.0, kind: overcurrent, node: elbow, duration_s: 0.2}]' --json >/dev/null
status=$?
[ $status -eq 1 ] || { echo "record.sh: the run ended with $status, not with the time limit's 1"; exit 1; }
[ -s "$2/can0.log" ] && [ -s "$2/joints.csv" ]
