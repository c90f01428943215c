#!/usr/bin/env bash
# The guest's CAN stack does what the other tests take for granted: frames pass, can-gw changes and drops them, vxcan joins two networks.
set -euo pipefail

expect() {
  [ "$2" = "$3" ] || { printf '%s: expected\n%s\ngot\n%s\n' "$1" "$2" "$3" >&2; exit 1; }
}

# heard INTERFACE COUNT COMMAND...: what candump logs of COUNT frames while COMMAND runs, or within 1 s.
heard() {
  local log
  log=$(mktemp)
  stdbuf -oL candump -L -n "$2" -T 1000 "$1" >"$log" &
  local dump=$!
  until grep -q "^ *$1 " /proc/net/can/rcvlist_all; do sleep 0.01; done  # candump listens
  "${@:3}"
  wait "$dump"
  cut -d ' ' -f 2- "$log"
}

expect "a frame passes" "vcan0 181#0011223344556677" "$(heard vcan0 1 cansend vcan0 181#0011223344556677)"

ip link add dev vcan1 type vcan
ip link set vcan1 up
both() {
  cansend vcan0 181#0011223344556677
  cansend vcan0 182#01
  cansend vcan0 183#02
}
cangw -A -s vcan0 -d vcan1 -e -f 181:7FF -m SET:D:181.8.FFFF000000000000
cangw -A -s vcan0 -d vcan1 -e -f 183:7FF
expect "can-gw changes one identifier and drops another" $'vcan1 181#FFFF000000000000\nvcan1 183#02' "$(heard vcan1 2 both)"
cangw -F

ip netns add other
ip link add dev vx0 type vxcan peer name vx1 netns other
ip link set vx0 up
ip -n other link set vx1 up
across() { ip netns exec other cansend vx1 201#AA; }
expect "vxcan joins two networks" "vx0 201#AA" "$(heard vx0 1 across)"
echo "a real CAN stack: $(uname -r)"
