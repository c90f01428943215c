#!/usr/bin/env bash
# A guest's runner ends with its command's exit status, and leaves nothing behind. Usage: exit_status_test.sh FOLDER_OF_RUNNERS
set -euo pipefail
TMPDIR=$(mktemp -d)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT

# ends STATUS COMMAND...: the command ends with STATUS in a guest.
ends() {
  local wanted=$1 status=0
  shift
  "$runners/with_vcan.sh" --time-limit 600 "$@" || status=$?
  if [ "$status" -eq 3 ]; then
    # Where CI=true, a guest has to boot.
    [ "${CI:-}" != true ] || exit 1
    echo "skipped: no guest on this machine"
    exit 77
  fi
  [ "$status" -eq "$wanted" ] || { echo "'$*' ended with $status, not with $wanted" >&2; exit 1; }
  [ -z "$(ls -A "$TMPDIR")" ] || { echo "'$*' left $(ls "$TMPDIR")" >&2; exit 1; }
}
runners=$1
ends 0 true
ends 5 bash -c 'exit 5'
ends 0 bash -c 'ip link show vcan0 | grep -q ,UP'
echo "a guest ends as its command does"
