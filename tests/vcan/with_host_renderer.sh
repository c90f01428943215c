#!/usr/bin/env bash
# Runs a command on vcan (toolchain/guests/with_vcan.sh) while `lanternfish render-frames` makes the simulated camera's pictures on this machine, which has
# the processors that a guest has not. The command hands LANTERNFISH_SHARED_FILE to `lanternfish serve --renderer`.
# Usage: with_host_renderer.sh LANTERNFISH SCENARIO SEED OPTION_OF_WITH_VCAN... COMMAND [ARGUMENT]...
set -euo pipefail
guests=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../toolchain/guests" && pwd)
lanternfish=$1 scenario=$2 seed=$3
shift 3

folder=$(mktemp -d)
renderer=
finish() {
  local status=$?
  [ -z "$renderer" ] || { kill "$renderer" && wait "$renderer"; } || true
  cat "$folder/log" || true
  rm -rf "$folder"
  exit "$status"
}
trap finish EXIT
# On the processors that the guest leaves, before what is not real-time: a picture is due 100 ms after it was asked for.
others=()
! chrt -f 10 true 2>/dev/null || others=(chrt -f 10)
"${others[@]}" "$lanternfish" render-frames "$scenario" "$folder/rings" --seed "$seed" >"$folder/log" 2>&1 &
renderer=$!
for _ in $(seq 200); do
  [ ! -s "$folder/rings" ] || break
  kill -0 "$renderer" 2>/dev/null || { echo "with_host_renderer: render-frames ended" >&2; exit 125; }
  sleep 0.1
done
"$guests/with_vcan.sh" --mmapper "$folder/rings" "$@"
