#!/usr/bin/env bash
# Runs a command as root of a network of its own in which vcan0 is up: with this machine's kernel where that has CAN, else in User Mode Linux.
# Usage: with_vcan.sh [--time-limit S] [--memory 512M] [--out FOLDER]... [--mmapper FILE] [--preload LIBRARY] [--slowdown N] COMMAND [ARGUMENT]...
#
# Options, exit status: those of run_in_uml.sh; this machine's kernel keeps this machine's time, whatever N. The command finds LANTERNFISH_GUEST=kernel or uml in its environment, and in LANTERNFISH_SHARED_FILE
# what FILE is there: FILE itself, or /dev/mmapper.
# Environment: LANTERNFISH_VCAN=kernel or uml asks for the one; LANTERNFISH_NO_UML=REASON forbids the other.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
PATH=$PATH:/usr/sbin:/sbin

options=() time_limit=60 shared_file=''
while [[ ${1:-} == --* ]]; do
  case $1 in
    --time-limit) time_limit=$2 ;;
    --mmapper) shared_file=$(realpath "$2") ;;
  esac
  options+=("$1" "$2")
  shift 2
done
[ $# -gt 0 ] || { sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2; }

command -v candump >/dev/null || { echo "with_vcan: no candump: apt-get install can-utils" >&2; exit 3; }

# A network, and process identifiers, that end with the command. Who is not root becomes it in a user namespace.
own=(unshare --net --pid --fork --kill-child --mount-proc)
[ "$(id -u)" -eq 0 ] || own+=(--user --map-root-user)
which=${LANTERNFISH_VCAN:-}
if [ -z "$which" ]; then
  which=uml
  modprobe -q vcan 2>/dev/null || true
  ! "${own[@]}" ip link add dev vcan0 type vcan 2>/dev/null || which=kernel
fi

if [ "$which" = kernel ]; then
  export LANTERNFISH_SHARED_FILE=$shared_file LANTERNFISH_GUEST=kernel
  status=0
  # shellcheck disable=SC2016  # for the shell inside
  timeout -s KILL "$time_limit" "${own[@]}" bash -c 'ip link set lo up; ip link add dev vcan0 type vcan; ip link set vcan0 up; exec "$@"' \
    with_vcan "$@" </dev/null || status=$?
  [ "$status" -ne 137 ] || { echo "with_vcan: not done after $time_limit s: $*" >&2; exit 124; }
  exit "$status"
fi
if [ -n "${LANTERNFISH_NO_UML:-}" ]; then
  echo "with_vcan: no vcan in this machine's kernel, and no User Mode Linux: $LANTERNFISH_NO_UML" >&2
  exit 3
fi
[ -z "$shared_file" ] || export LANTERNFISH_SHARED_FILE=/dev/mmapper
exec "$here/run_in_uml.sh" "${options[@]}" "$@"
