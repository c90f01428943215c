#!/usr/bin/env bash
# Runs a command in User Mode Linux, a kernel of its own that is an ordinary process: it has SocketCAN where the machine's kernel has none.
# Usage: run_in_uml.sh [--time-limit S] [--memory 512M] [--out FOLDER]... [--mmapper FILE] COMMAND [ARGUMENT]...
#
# The guest has one processor and keeps this machine's time. It sees this machine's files, in the same places, read-only; /tmp, /var/tmp, /run and /dev/shm are its own and empty, and each FOLDER
# of --out is this machine's and may be written. The command runs as the guest's root, in the present folder and environment, with vcan0 up and
# the modules for vcan, vxcan and can-gw loaded. FILE, a multiple of the page size, is the guest's /dev/mmapper, shared both ways.
# Exit status: the command's; 3 when something has to be installed; 124 when the time limit (60 s) is over; 125 when the guest itself failed.
# Environment: LANTERNFISH_GUEST_CPU, the processor to run on (default: the last one allowed).
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
PATH=$PATH:/usr/sbin:/sbin

time_limit=60 memory=512M mmapper='' out=()
while [[ ${1:-} == --* ]]; do
  case $1 in
    --time-limit) time_limit=$2 ;;
    --memory) memory=$2 ;;
    --out) out+=("$(realpath "$2")") ;;
    --mmapper) mmapper=$(realpath "$2") ;;
    *) echo "run_in_uml: no such option: $1" >&2; exit 2 ;;
  esac
  shift 2
done
[ $# -gt 0 ] || { sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2; }

for need in linux.uml:user-mode-linux ip:iproute2 insmod:kmod; do
  command -v "${need%%:*}" >/dev/null && continue
  echo "run_in_uml: no ${need%%:*}: apt-get install ${need##*:}" >&2
  exit 3
done

private=$(mktemp -d)
trap 'rm -rf "$private"' EXIT
{
  export -p
  echo "export LANTERNFISH_GUEST=uml"
  printf 'project=%q here=%q out=(%s) command=(%s)\n' "$(realpath "$here/../..")" "$PWD" \
    "$([ ${#out[@]} -eq 0 ] || printf '%q ' "${out[@]}")" "$(printf '%q ' "$@")"
} >"$private/settings"

# One processor of its own, before all that is not real-time: unpinned on a busy machine the guest loses frames at 500 Hz.
cpu=${LANTERNFISH_GUEST_CPU:-$(taskset -cp $$ | sed 's/.*[ ,-]//')}
pinned=(taskset -c "$cpu")
chrt -f 20 true 2>/dev/null && pinned+=(chrt -f 20)

# The kernel's messages go to a file; the command's output and errors come through consoles of their own.
status=0
timeout -k 5 "$time_limit" "${pinned[@]}" linux.uml mem="$memory" ${mmapper:+iomem=mmapper,"$mmapper"} uml_dir="$private/" \
  rootfstype=hostfs rootflags=/ ro init="$here/uml_init.sh" LANTERNFISH_PRIVATE="$private" \
  con=null con0=null,fd:3 con1=null,fd:4 con2=null,fd:5 3>"$private/kernel.log" 4>&1 5>&2 </dev/null >>"$private/kernel.log" 2>&1 || status=$?
if [ -s "$private/status" ]; then
  exit "$(cat "$private/status")"
elif [ "$status" -ge 124 ]; then
  echo "run_in_uml: not done after $time_limit s: $*" >&2
  status=124
else
  echo "run_in_uml: the guest ended ($status) before the command did" >&2
  status=125
fi
tail -n 20 "$private/kernel.log" >&2
exit "$status"
