#!/usr/bin/env bash
# The guest has what the other tests take for granted: two kvaser_pci controllers on one bus, and V4L2 loopback devices.
set -euo pipefail
for interface in can0 can1; do
  driver=$(basename "$(readlink "/sys/class/net/$interface/device/driver")")
  [ "$driver" = kvaser_pci ] || { echo "$interface is driven by $driver" >&2; exit 1; }
done
cangen can0 -n 1  # reads the program; the guest's clock jumps meanwhile
candump -L -n 100 -T 20000 can1 >/tmp/heard &
until grep -q '^ *can1 ' /proc/net/can/rcvlist_all; do sleep 0.01; done  # candump listens
cangen can0 -n 100 -g 1 -I i -L 8 -D i
wait
count=$(wc -l </tmp/heard)
[ "$count" -eq 100 ] || { echo "can1 heard $count frames of 100" >&2; exit 1; }
for device in video0 video1; do
  grep -q loop "/sys/class/video4linux/$device/name" || grep -qi dummy "/sys/class/video4linux/$device/name" ||
    { echo "$device is no loopback device: $(cat /sys/class/video4linux/$device/name)" >&2; exit 1; }
done
echo "two CAN cards and two loopback cameras: $(uname -r)"
