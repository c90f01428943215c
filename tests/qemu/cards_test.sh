#!/usr/bin/env bash
# The guest has what the other tests take for granted: two kvaser_pci controllers on one bus, and V4L2 loopback devices.
set -euo pipefail
for interface in can0 can1; do
  driver=$(basename "$(readlink "/sys/class/net/$interface/device/driver")")
  [ "$driver" = kvaser_pci ] || { echo "$interface is driven by $driver" >&2; exit 1; }
done
# Reads the programs: the guest's clock jumps meanwhile.
cangen can0 -n 1
candump -L -n 1 -T 1 can1 >/tmp/heard
grep -c . /tmp/heard || true
sleep 0.01
candump -L -n 100 can1 >/tmp/heard &
listener=$!
# soon COMMAND...: waits until it succeeds, for some seconds.
soon() {
  for _ in $(seq 500); do
    "$@" && return
    sleep 0.01
  done
  echo "not within some seconds: $*" >&2
  exit 1
}
soon grep -q '^ *can1 ' /proc/net/can/rcvlist_all  # candump listens
cangen can0 -n 100 -g 1 -I i -L 8 -D i
heard_all() { ! kill -0 "$listener" 2>/dev/null; }
soon heard_all
wait
count=$(wc -l </tmp/heard)
[ "$count" -eq 100 ] || { echo "can1 heard $count frames of 100" >&2; exit 1; }
for device in video0 video1; do
  grep -q loop "/sys/class/video4linux/$device/name" || grep -qi dummy "/sys/class/video4linux/$device/name" ||
    { echo "$device is no loopback device: $(cat /sys/class/video4linux/$device/name)" >&2; exit 1; }
done
echo "two CAN cards and two loopback cameras: $(uname -r)"
