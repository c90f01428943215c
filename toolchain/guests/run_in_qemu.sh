#!/usr/bin/env bash
# Runs a command in an emulated PC with Debian's kernel, two SJA1000 controllers (kvaser_pci) as can0 and can1 on one bus, and /dev/video0 and
# /dev/video1 that loop back (v4l2loopback); `insmod /run/modules/vivid.ko` gives it a camera that can be told to fail. Its clock counts
# instructions, so what is timed in it does not depend on what else this machine does.
# Usage: run_in_qemu.sh --guest FOLDER [--time-limit S] [--memory MB] [--out FOLDER]... COMMAND [ARGUMENT]...
#
# --guest is the folder of make_qemu_guest.sh, which is filled at the first use. The guest sees this machine's files, in the same places, read-only;
# /tmp, /var/tmp, /run and /dev/shm are its own and empty, and each FOLDER of --out is this machine's and may be written. The command runs as root
# in the present folder and environment; its output is shown when it has ended. While the guest reads this machine's files its clock jumps: copy to
# /tmp what a timed program opens.
# Exit status: the command's; 3 when something has to be installed, or no guest boots here; 124 when the time limit (120 s) is over; 125 when the
# guest failed after it had booted.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

time_limit=120 memory=1024 guest='' out=()
while [[ ${1:-} == --* ]]; do
  case $1 in
    --guest) guest=$2 ;;
    --time-limit) time_limit=$2 ;;
    --memory) memory=$2 ;;
    --out) out+=("$(realpath "$2")") ;;
    *) echo "run_in_qemu: no such option: $1" >&2; exit 2 ;;
  esac
  shift 2
done
[ $# -gt 0 ] && [ -n "$guest" ] || { sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
for need in qemu-system-x86_64:qemu-system-x86 candump:can-utils v4l2-ctl:v4l-utils; do
  command -v "${need%%:*}" >/dev/null && continue
  echo "run_in_qemu: no ${need%%:*}: apt-get install ${need##*:}" >&2
  exit 3
done
"$here/make_qemu_guest.sh" "$guest"

private=$(mktemp -d)
trap 'rm -rf "$private"' EXIT
project=$(realpath "$here/../..")
shares=(-fsdev "local,id=project,path=$project,security_model=none,readonly=on,multidevs=remap" -device virtio-9p-pci,fsdev=project,mount_tag=project)
for i in "${!out[@]}"; do
  shares+=(-fsdev "local,id=out$i,path=${out[$i]},security_model=none" -device "virtio-9p-pci,fsdev=out$i,mount_tag=out$i")
done
cp "$here/qemu_start.sh" "$private/start"
{
  export -p
  echo "export LANTERNFISH_GUEST=qemu"
  printf 'project=%q here=%q out=(%s) command=(%s)\n' "$project" "$PWD" "$([ ${#out[@]} -eq 0 ] || printf '%q ' "${out[@]}")" "$(printf '%q ' "$@")"
} >"$private/settings"

status=0
timeout -k 5 "$time_limit" qemu-system-x86_64 -machine q35,accel=tcg -icount shift=1,sleep=off -cpu max -smp 1 -m "$memory" \
  -display none -no-reboot -nodefaults -serial "file:$private/kernel.log" \
  -kernel "$guest/vmlinuz" -initrd "$guest/initramfs.gz" -append "console=ttyS0 quiet panic=-1 mitigations=off tsc=reliable preempt=full" \
  -object can-bus,id=bus -device kvaser_pci,canbus=bus -device kvaser_pci,canbus=bus \
  -fsdev local,id=hostroot,path=/,security_model=none,readonly=on,multidevs=remap -device virtio-9p-pci,fsdev=hostroot,mount_tag=hostroot \
  -fsdev "local,id=private,path=$private,security_model=none" -device virtio-9p-pci,fsdev=private,mount_tag=private \
  "${shares[@]}" </dev/null >"$private/qemu.log" 2>&1 || status=$?
cat "$private/stdout" 2>/dev/null || true
cat "$private/stderr" >&2 2>/dev/null || true
if [ -s "$private/status" ]; then
  exit "$(cat "$private/status")"
fi
if [ ! -e "$private/booted" ]; then
  tail -n 20 "$private/qemu.log" "$private/kernel.log" >&2 || true
  echo "run_in_qemu: no guest boots here: QEMU ended with $status" >&2
  exit 3
elif [ "$status" -eq 124 ] || [ "$status" -eq 137 ]; then
  echo "run_in_qemu: not done after $time_limit s: $*" >&2
  status=124
else
  echo "run_in_qemu: the guest ended ($status) before the command did" >&2
  status=125
fi
tail -n 20 "$private/qemu.log" "$private/kernel.log" >&2 || true
exit "$status"
