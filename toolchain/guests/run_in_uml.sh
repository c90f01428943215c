#!/usr/bin/env bash
# Runs a command in User Mode Linux, a kernel of its own that is an ordinary process: it has SocketCAN where the machine's kernel has none.
# Usage: run_in_uml.sh [--time-limit S] [--memory 512M] [--out FOLDER]... [--mmapper FILE] [--preload LIBRARY] [--slowdown N] COMMAND [ARGUMENT]...
#
# The guest has one processor and keeps this machine's time; with N, its clock goes N times slower. N and processors with AMX need LIBRARY, which is built of
# slow_clock.cpp and whole_xstate.cpp; the one in build/release is taken where none is named. The guest sees this machine's files, in the same places,
# read-only; /tmp, /var/tmp, /run and /dev/shm are its own and empty, and each FOLDER of --out is this machine's and may be written. The command runs as the
# guest's root, in the present folder and environment, with vcan0 up and the modules for vcan, vxcan and can-gw loaded. FILE, a multiple of the page size,
# is the guest's /dev/mmapper, shared both ways.
# Exit status: the command's; 3 when something has to be installed, or no guest boots here; 124 when the time limit (60 s of this machine) is over;
# 125 when the guest failed after it had booted.
# Environment: LANTERNFISH_GUEST_CPU, the processor to run on (default: the last one allowed).
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
PATH=$PATH:/usr/sbin:/sbin

time_limit=60 memory=512M mmapper='' slowdown=1 preload='' out=()
while [[ ${1:-} == --* ]]; do
  case $1 in
    --time-limit) time_limit=$2 ;;
    --memory) memory=$2 ;;
    --out) out+=("$(realpath "$2")") ;;
    --mmapper) mmapper=$(realpath "$2") ;;
    --slowdown) slowdown=$2 ;;
    --preload) preload=$(realpath "$2") ;;
    *) echo "run_in_uml: no such option: $1" >&2; exit 2 ;;
  esac
  shift 2
done
[ $# -gt 0 ] || { sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
built=$here/../../build/release/tests/libuml_preload.so
[ -n "$preload" ] || [ ! -e "$built" ] || preload=$(realpath "$built")
[ "$slowdown" -eq 1 ] || [ -n "$preload" ] || { echo "run_in_uml: --slowdown wants --preload" >&2; exit 2; }

for need in linux.uml:user-mode-linux ip:iproute2 insmod:kmod; do
  command -v "${need%%:*}" >/dev/null && continue
  echo "run_in_uml: no ${need%%:*}: apt-get install ${need##*:}" >&2
  exit 3
done

private=$(mktemp -d)
guest=''
finish() {
  local status=$?
  [ -z "$guest" ] || kill "$guest" 2>/dev/null || true  # gone by itself as a rule
  rm -rf "$private"
  exit "$status"
}
trap finish EXIT
{
  export -p
  echo "export LANTERNFISH_GUEST=uml LANTERNFISH_SLOWDOWN=$slowdown"
  printf 'project=%q here=%q out=(%s) command=(%s)\n' "$(realpath "$here/../..")" "$PWD" \
    "$([ ${#out[@]} -eq 0 ] || printf '%q ' "${out[@]}")" "$(printf '%q ' "$@")"
} >"$private/settings"

# One processor of its own, before all that is not real-time: unpinned on a busy machine the guest loses frames at 500 Hz.
cpu=${LANTERNFISH_GUEST_CPU:-$(taskset -cp $$ | sed 's/.*[ ,-]//')}
pinned=(taskset -c "$cpu")
! chrt -f 20 true 2>/dev/null || pinned+=(chrt --reset-on-fork -f 20)

kernel=(linux.uml)
[ -z "$preload" ] || kernel=(env LD_PRELOAD="$preload" LANTERNFISH_SLOWDOWN="$slowdown" linux.uml)

# The guest's programs are children of its kernel, each a process here. Real-time like the kernel, one that computes would keep it from its timer until
# the next system call, 50 ms and more; and together they would be throttled (sched_rt_runtime_us). So they are ordinary, and first among these.
put_programs_first() {
  local kernel='' child children known=' '
  chrt -f -p 21 "$BASHPID"
  until [ -n "$kernel" ]; do
    read -r kernel _ <"/proc/$1/task/$1/children" || true  # no newline ends these files
    read -rt 0.01 <>"$private/never" || true
  done
  while [ -e "/proc/$kernel" ]; do
    read -ra children <"/proc/$kernel/task/$kernel/children" || true
    for child in "${children[@]}"; do
      [[ $known == *" $child "* ]] || { renice -n -20 -p "$child" >"$private/reniced" && known+="$child "; }
    done
    read -rt 0.02 <>"$private/never" || true
  done
} 2>/dev/null

# Where User Mode Linux cannot be (no ptrace, no memory to execute), it may hang as well as end.
give_up_if_it_does_not_boot() {
  for _ in $(seq 600); do
    [ ! -e "$private/booted" ] && [ -e "/proc/$1" ] || return 0
    read -rt 0.1 <>"$private/never" || true
  done
  kill "$1"
} 2>/dev/null

# The guest's memory is a file: in RAM where there is room for it (a container's /dev/shm may have 64 MB).
memory_folder=$private
room_mb=$(df --output=avail -BM /dev/shm 2>/dev/null | tail -n 1 | tr -dc 0-9)
[ "${room_mb:-0}" -lt "$(($(numfmt --from=iec "$memory") >> 20))" ] || memory_folder=/dev/shm

# The kernel's messages go to a file; the command's output and errors come through consoles of their own.
mkfifo "$private/never"
status=0
TMPDIR=$memory_folder timeout -k 5 "$time_limit" "${pinned[@]}" "${kernel[@]}" mem="$memory" ${mmapper:+iomem=mmapper,"$mmapper"} uml_dir="$private/" \
  rootfstype=hostfs rootflags=/ ro init="$here/uml_init.sh" LANTERNFISH_PRIVATE="$private" \
  con=null con0=null,fd:3 con1=null,fd:4 con2=null,fd:5 3>"$private/kernel.log" 4>&1 5>&2 </dev/null >>"$private/kernel.log" 2>&1 &
guest=$!
give_up_if_it_does_not_boot "$guest" &
if [ ${#pinned[@]} -gt 3 ]; then
  put_programs_first "$guest" &
fi
wait "$guest" || status=$?
if [ -s "$private/status" ]; then
  exit "$(cat "$private/status")"
elif [ ! -e "$private/booted" ]; then
  tail -n 20 "$private/kernel.log" >&2
  echo "run_in_uml: no guest boots here: User Mode Linux ended with $status" >&2
  exit 3
elif [ "$status" -eq 124 ] || [ "$status" -eq 137 ]; then
  echo "run_in_uml: not done after $time_limit s: $*" >&2
  status=124
else
  echo "run_in_uml: the guest ended ($status) before the command did" >&2
  status=125
fi
tail -n 60 "$private/kernel.log" >&2
exit "$status"
