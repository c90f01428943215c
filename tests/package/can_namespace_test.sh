#!/usr/bin/env bash
# lanternfish-can moves the interface that it was told, and no other, into the daemon's network namespace. Usage: can_namespace_test.sh SERVICE_FOLDER
# Runs as root of a guest with vcan (toolchain/guests).
set -euo pipefail
script=$1/lanternfish-can
fail() { echo "$*" >&2; exit 1; }
mkdir -p /run/netns
ip link add dev vcan7 type vcan
ip link add dev vcan8 type vcan
ip link set dev vcan8 up

"$script" up 2>&1 | grep -q "CAN_INTERFACE is not set" || fail "without a name it says nothing"
ip link show dev vcan7 >/dev/null || fail "without a name an interface was taken"
[ -e /run/netns/lanternfish ] || fail "without a name there is no namespace for the daemon"

export CAN_INTERFACE=vcan7 CAN_BITRATE=1000000 CAN_QUEUE=32
CAN_INTERFACE=vcan9 "$script" up 2>&1 | grep -q "no interface vcan9" || fail "an interface that is not there is not named"
for _ in 1 2; do "$script" up; done
ip link show dev vcan7 >/dev/null 2>&1 && fail "the interface is still everybody's"
ip link show dev vcan8 >/dev/null || fail "another interface was taken"
ip -n lanternfish link show dev vcan7 | grep -q ',UP' || fail "the interface is not up in the namespace"
ip -n lanternfish link show dev vcan7 | grep -q 'qlen 32' || fail "the queue is not 32 frames long"

# Frames pass inside, and nobody outside hears or sends one.
ip netns exec lanternfish candump -L -n 1 -T 2000 vcan7 >/tmp/heard &
sleep 0.5
cansend vcan7 123#01 2>/dev/null && fail "a program outside reaches the bus"
cansend vcan8 124#02
ip netns exec lanternfish cansend vcan7 125#03
wait
grep -q '125#03' /tmp/heard || fail "heard $(cat /tmp/heard)"

# It went away and came back, as a USB adapter does.
ip -n lanternfish link del dev vcan7
ip link add dev vcan7 type vcan
"$script" up
ip -n lanternfish link show dev vcan7 | grep -q ',UP' || fail "the interface that came back is not in the namespace"
"$script" down
"$script" down
[ ! -e /run/netns/lanternfish ] || fail "the namespace is left"
echo "the bus is the daemon's own"
