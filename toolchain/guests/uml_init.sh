#!/bin/bash
# The first process of the guest that run_in_uml.sh starts: file systems, modules, vcan0, the command, power off.
# LANTERNFISH_PRIVATE, from the kernel's command line, is this machine's folder with `settings` to read and `status` to write.
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
stty raw -echo </dev/tty1 2>/dev/null
stty raw -echo </dev/tty2 2>/dev/null
mount -t proc proc /proc
mount -t sysfs sys /sys
mountpoint -q /dev || mount -t devtmpfs dev /dev
ln -sf /proc/self/fd /dev/fd
mkdir -p /dev/pts && mount -t devpts devpts /dev/pts

private=$LANTERNFISH_PRIVATE
unset LANTERNFISH_PRIVATE
settings=$(<"$private/settings")  # now: what is mounted next may hide it
for folder in /tmp /var/tmp /run /dev/shm; do
  mkdir -p "$folder" && mount -t tmpfs -o mode=1777 tmpfs "$folder"
done

# host_folder FOLDER MODE: the machine's FOLDER, even where a tmpfs hides it.
host_folder() {
  mkdir -p "$1" 2>/dev/null
  mount -t hostfs -o "$1" hostfs "$1" && mount -o "remount,$2" "$1"
}
host_folder "$private" rw
: >"$private/booted"
eval "$settings"
[ -e "$project" ] || host_folder "$project" ro
for folder in "${out[@]}"; do host_folder "$folder" rw; done

modules=/lib/modules/$(uname -r)/kernel
[ -d "$modules" ] || modules=/usr/lib/uml/modules/$(uname -r)/kernel
for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan drivers/net/can/vxcan net/can/can-gw net/sched/sch_tbf; do
  insmod "$modules/$module.ko" || echo "uml_init: no module $module"
done
ip link set lo up
ip link add dev vcan0 type vcan && ip link set vcan0 up

cd "$here" || cd /
"${command[@]}" </dev/null >/dev/tty1 2>/dev/tty2
status=$?
echo "$status" >"$private/status"
sync
echo o >/proc/sysrq-trigger
sleep 10
