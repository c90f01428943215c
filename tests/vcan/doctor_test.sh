#!/bin/sh
# What the doctor says of an interface that a kernel has: up, down, and away. Usage: doctor_test.sh LANTERNFISHD, in a guest that has vcan0
set -eu
daemon=$1
PATH=$PATH:/usr/sbin:/sbin
cat >/tmp/doctor.yaml <<'YAML'
can: {interface: vcan0}
camera: {source: none}
homing: {file: homing/simulator.yaml}
operator: {socket: /tmp/operator.sock}
log: {folder: /tmp/log, file_mb: 1, keep: 1}
lock_folder: /tmp
YAML
# says PATTERN: a line of what the doctor finds on this machine.
says() {
  said=$("$daemon" --config /tmp/doctor.yaml doctor --machine) || true
  echo "$said" | grep -qE "$1" || { echo "no line like '$1' in:"; echo "$said"; exit 1; }
}
says '^CAN sockets +good '
says '^interface +good +vcan0 is up, kind vcan$'
says '^bit rate +good +vcan0 has none: it is vcan$'
says "^transmit queue +good +vcan0 queues $(cat /sys/class/net/vcan0/tx_queue_len) frames$"

# Nobody is on the bus: that is read and told, by an exit status of its own.
status=0
said=$("$daemon" doctor --bus --interface vcan0 --json) || status=$?
[ "$status" = 1 ] || { echo "status $status, not 1: $said"; exit 1; }
echo "$said" | grep -q '"agrees": false' || { echo "$said"; exit 1; }

ip link set vcan0 down
says '^interface +BAD +vcan0 is down$'
ip link del vcan0
says '^interface +BAD +there is no interface vcan0$'
echo "good"
