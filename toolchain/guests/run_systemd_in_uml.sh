#!/usr/bin/env bash
# Boots a root folder with its own systemd in User Mode Linux, runs a script of it as a unit, and powers off.
# Usage: run_systemd_in_uml.sh --root FOLDER [--time-limit S] [--memory 768M] [--preload LIBRARY] SCRIPT    SCRIPT: a path in FOLDER; LIBRARY as for run_in_uml.sh
#
# FOLDER is a Debian root with systemd (tests/package/clean_root.py --with systemd). It is copied into an image and stays as it is. The script runs as root once
# basic.target is reached; its output is shown. The kernel's modules for CAN are in /lib/modules/can, in the order of insmod.
# Exit status: the script's; 3 when something has to be installed, or no guest boots here; 124 when the time limit (120 s) is over; 125 when the guest ended
# before the script did.
set -euo pipefail
PATH=$PATH:/usr/sbin:/sbin
root='' time_limit=120 memory=768M kernel=(linux.uml)
while [[ ${1:-} == --* ]]; do
  case $1 in
    --root) root=$2 ;;
    --time-limit) time_limit=$2 ;;
    --memory) memory=$2 ;;
    --preload) kernel=(env LD_PRELOAD="$(realpath "$2")" linux.uml) ;;
    *) echo "run_systemd_in_uml: no such option: $1" >&2; exit 2 ;;
  esac
  shift 2
done
[ $# -eq 1 ] && [ -n "$root" ] || { sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2; }
for need in linux.uml:user-mode-linux mke2fs:e2fsprogs; do
  command -v "${need%%:*}" >/dev/null && continue
  echo "run_systemd_in_uml: no ${need%%:*}: apt-get install ${need##*:}" >&2
  exit 3
done

private=$(mktemp -d)
trap 'rm -rf "$private"' EXIT
[ -x "$root/lib/systemd/systemd" ] || { echo "run_systemd_in_uml: $root has no systemd" >&2; exit 2; }

# What asks a person, or waits for hardware that is not there.
for unit in systemd-firstboot.service getty.target systemd-timesyncd.service systemd-networkd.service systemd-resolved.service systemd-logind.service; do
  ln -sf /dev/null "$root/etc/systemd/system/$unit"
done
[ -s "$root/etc/machine-id" ] || echo 0123456789abcdef0123456789abcdef >"$root/etc/machine-id"
: >"$root/etc/fstab"
cat >"$root/etc/systemd/system/guest.target" <<TARGET
[Unit]
Requires=basic.target guest.service
After=basic.target
AllowIsolate=yes
TARGET
cat >"$root/etc/systemd/system/guest.service" <<UNIT
[Unit]
After=basic.target
[Service]
Type=oneshot
TimeoutStartSec=infinity
ExecStart=/bin/bash -c 'echo booted >/dev/tty2; "$1" >/dev/tty1 2>&1; echo "status \$?" >/dev/tty2; systemctl poweroff -ff'
UNIT
mkdir -p "$root/lib/modules/can"
uml_modules=$({ ls -d "/lib/modules/$(linux.uml --version)" "/usr/lib/uml/modules/$(linux.uml --version)" 2>/dev/null || true; } | head -n 1)
[ -n "$uml_modules" ] || { echo "run_systemd_in_uml: no modules of $(linux.uml --version): apt-get install user-mode-linux" >&2; exit 3; }
number=0
for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan; do
  number=$((number + 1))
  cp "$uml_modules/kernel/$module.ko" "$root/lib/modules/can/$number-$(basename "$module").ko"
done

size_mb=$(($(du -sm "$root" | cut -f1) + 200))
mke2fs -q -t ext4 -d "$root" "$private/image" "${size_mb}M" 2>"$private/mke2fs.log" >&2 || { cat "$private/mke2fs.log" >&2; exit 125; }
status=0
timeout -k 5 "$time_limit" "${kernel[@]}" mem="$memory" ubd0="$private/image" root=/dev/ubda rw uml_dir="$private/" init=/lib/systemd/systemd \
  systemd.unit=guest.target con=null con0=null,fd:3 con1=null,fd:4 con2=null,fd:5 3>"$private/kernel.log" 4>&1 5>"$private/status" \
  </dev/null >>"$private/kernel.log" 2>&1 || status=$?
if said=$(grep -aoE 'status [0-9]+' "$private/status"); then exit "${said#status }"; fi
tail -n 40 "$private/kernel.log" >&2
if ! grep -qa booted "$private/status"; then
  echo "run_systemd_in_uml: no guest boots here: User Mode Linux ended with $status" >&2
  exit 3
elif [ "$status" -eq 124 ] || [ "$status" -eq 137 ]; then
  echo "run_systemd_in_uml: not done after $time_limit s" >&2
  exit 124
fi
echo "run_systemd_in_uml: the guest ended ($status) before the script did" >&2
exit 125
